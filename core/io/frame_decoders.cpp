// SPDX-License-Identifier: Apache-2.0
#include "core/io/frame_decoders.hpp"

#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "core/error.hpp"
#include "core/io/files.hpp"
#include "core/io/image_files.hpp"
#include "core/io/media_log.hpp"
#include "core/io/reading/missing_numbers.hpp"
#include "core/io/tiff/axes.hpp"
#include "core/io/tiff_pages.hpp"
#include "core/text/format_number.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

void report(const core::Warn& warn, const std::string& line) {
  if (warn) warn(line);
}

class VideoFileDecoder final : public FrameDecoder {
 public:
  VideoFileDecoder(const fs::path& path, const core::Warn& warn) : path_(path), warn_(warn) {
    open();
    grey_ = stream_is_grey();
    info_.fps = rate();
    const double claimed = video_.get(cv::CAP_PROP_FRAME_COUNT);
    if (claimed >= 1 && claimed < 1e12) info_.frames = claimed_ = std::llround(claimed);
    if (!read(first_))
      throw core::IoError("cannot read " + path_.string() + ": not one frame of it can be decoded");
    info_.width = first_.cols;
    info_.height = first_.rows;
    info_.channels = grey_ || first_.channels() == 1 ? 1 : 3;
    info_.depth = CV_8U;
  }

  [[nodiscard]] const core::ClipInfo& info() const override { return info_; }

  cv::Mat next() override {
    cv::Mat frame;
    if (!first_.empty())
      frame = std::exchange(first_, {});
    else if (ended_ || !read(frame))
      return end();
    if (frame.size() != cv::Size(info_.width, info_.height))
      throw core::IoError(path_.string() + ": frame " + std::to_string(position_) + " is " +
                          core::size_text(frame.size()) + " pixels, those before it " +
                          core::size_text({info_.width, info_.height}));
    ++position_;
    if (info_.channels == frame.channels()) return frame;
    cv::Mat grey;
    cv::extractChannel(frame, grey, 0);
    return grey;
  }

  bool skip() override {
    if (!first_.empty())
      first_.release();
    else if (ended_ || !video_.grab())
      return !end().empty();
    else
      check_time();
    ++position_;
    return true;
  }

  void rewind() override {
    if (position_ == 0 && !ended_) return;
    open();  // a seek to frame 0 does not hit it in every container
    first_.release();
    position_ = 0;
    ended_ = false;
  }

 private:
  void open() {
    // An absolute name has no colon that FFmpeg would take for a protocol. Decoding on a graphics card may
    // round differently, so it is left out.
    video_.release();
    time_.reset();
    video_.open(fs::absolute(path_).string(), cv::CAP_FFMPEG,
                {cv::CAP_PROP_HW_ACCELERATION, cv::VIDEO_ACCELERATION_NONE});
    if (!video_.isOpened())
      throw core::IoError("cannot read " + path_.string() + ": it is no video that FFmpeg can open");
    video_.set(cv::CAP_PROP_ORIENTATION_AUTO, 0);
    turn_ = clockwise_turn();
  }

  /// OpenCV 4.6 turns (and tells) the flag the wrong way round, so that the frames stand on their heads;
  /// turned here, they are right with every version.
  std::optional<cv::RotateFlags> clockwise_turn() {
    const auto degrees = std::lround(video_.get(cv::CAP_PROP_ORIENTATION_META));
    const bool reversed = cv::getVersionMajor() == 4 && cv::getVersionMinor() == 6;
    switch (((reversed ? -degrees : degrees) % 360 + 360) % 360) {
      case 90:
        return cv::ROTATE_90_CLOCKWISE;
      case 180:
        return cv::ROTATE_180;
      case 270:
        return cv::ROTATE_90_COUNTERCLOCKWISE;
      default:
        return std::nullopt;
    }
  }

  bool read(cv::Mat& frame) {
    if (!video_.read(frame) || frame.empty()) return false;
    check_time();
    if (turn_) cv::rotate(frame.clone(), frame, *turn_);
    return true;
  }

  /// Tells once of a frame that comes much later or earlier after the one before than the rate says.
  void check_time() {
    const double time = video_.get(cv::CAP_PROP_POS_MSEC);
    const std::optional<double> before = std::exchange(time_, time);
    if (uneven_told_ || !before || *before < 0 || time <= 0 || !info_.fps_is_known) return;
    constexpr double kUneven = 0.3, kRounding = 2;  // share of the interval; ms
    const double usual = 1000 / info_.fps, step = time - *before;
    if (std::abs(step - usual) < std::max(kUneven * usual, kRounding)) return;
    uneven_told_ = true;
    const auto ms = [](double value) { return core::significant_text(value, 3) + " ms"; };
    report(warn_, path_.string() + ": its frames are not evenly spaced in time (" + ms(usual) +
                      " on average, " + ms(step) + " at frame " + std::to_string(position_) +
                      "); they are taken as if they were");
  }

  /// OpenCV hands over three channels whatever the stream holds; its pixel format tells Y800 (8 bits) or
  /// Y1 0 b (b bits) for grey.
  bool stream_is_grey() {
    const double format = video_.get(cv::CAP_PROP_CODEC_PIXEL_FORMAT);
    if (!(format > 0 && format < 4294967296.0)) return false;
    const auto code = static_cast<std::uint32_t>(format);
    return code == 0x30303859U || (code & 0xFFFFFFU) == 0x003159U;
  }

  double rate() {
    const double fps = video_.get(cv::CAP_PROP_FPS);
    if (fps > 0 && fps <= 1000) return fps;
    info_.fps_is_known = false;
    return 25;
  }

  cv::Mat end() {
    if (!ended_ && !warned_ && claimed_ && position_ + 1 < *claimed_) {
      report(warn_, path_.string() + ": only " + std::to_string(position_) + " of the " +
                        std::to_string(*claimed_) +
                        " frames that it promises can be read; it may be cut off");
      warned_ = true;
    }
    ended_ = true;
    info_.frames = position_;
    return {};
  }

  fs::path path_;
  core::Warn warn_;
  cv::VideoCapture video_;
  std::optional<cv::RotateFlags> turn_;
  core::ClipInfo info_;
  std::optional<std::int64_t> claimed_;
  cv::Mat first_;  ///< read to learn the size, not handed out yet
  std::int64_t position_ = 0;
  std::optional<double> time_;  ///< of the frame read last, ms
  bool grey_ = false, ended_ = false, warned_ = false, uneven_told_ = false;
};

std::string depth_text(int depth) {
  return depth == CV_8U ? "8 bits" : depth == CV_16U ? "16 bits" : "floats";
}

class ImageDecoder final : public FrameDecoder {
 public:
  ImageDecoder(std::vector<fs::path> files, const ReadOptions& options, const core::Warn& warn)
      : files_(std::move(files)), to_grey_(options.grey), channel_(options.channel), warn_(warn) {
    const ImageFile first = read_image(files_.front(), channel_);
    info_.width = first.pixels.cols;
    info_.height = first.pixels.rows;
    info_.channels = to_grey_ ? 1 : first.pixels.channels();
    info_.depth = first.pixels.depth();
    info_.frames = static_cast<std::int64_t>(files_.size());
    info_.fps_is_known = false;
    if (info_.depth != CV_8U) info_.white = info_.depth == CV_16U ? 65535 : 1;
    if (is_tiff(files_.front()))
      info_.pixel_um = read_tiff_axes(files_.front(), read_tiff_pages(files_.front())).pixel_um;
    if (const std::string gaps = missing_numbers(files_); !gaps.empty()) report(warn_, gaps);
  }

  [[nodiscard]] const core::ClipInfo& info() const override { return info_; }

  cv::Mat next() override {
    if (position_ == files_.size()) return {};
    return load(files_[position_++]);
  }

  bool skip() override {
    if (position_ == files_.size()) return false;
    ++position_;
    return true;
  }

  void rewind() override { position_ = 0; }

 private:
  cv::Mat load(const fs::path& file) {
    ImageFile image = read_image(file, channel_);
    cv::Mat& pixels = image.pixels;
    const auto differs = [&](const std::string& is, const std::string& first) {
      throw core::IoError("the image " + file.string() + " is " + is + ", the clip's first, " +
                          files_.front().filename().string() + ", is " + first);
    };
    const cv::Size size(info_.width, info_.height);
    if (pixels.size() != size) differs(core::size_text(pixels.size()) + " pixels", core::size_text(size));
    if (pixels.depth() != info_.depth)
      differs("of " + depth_text(pixels.depth()), "of " + depth_text(info_.depth));
    for (const auto& note : image.notes)
      if (noted_.insert(note).second)
        report(warn_,
               file.string() + ": " + note + (files_.size() > 1 ? ", and so for the images after it" : ""));
    if (image.pages > 1 && !std::exchange(warned_pages_, true))
      report(warn_,
             file.string() + " has " + std::to_string(image.pages) +
                 " pages, of which the first is taken, and so it is of the images after it; give the file "
                 "itself to read all of its pages");
    if (to_grey_) return to_grey(pixels);
    if (info_.channels == 1 && pixels.channels() == 3)
      differs("in colour", "grey (ask for a grey clip to mix them)");
    if (info_.channels == 3 && pixels.channels() == 1) cv::cvtColor(pixels, pixels, cv::COLOR_GRAY2BGR);
    return pixels;
  }

  std::vector<fs::path> files_;
  bool to_grey_;
  std::optional<int> channel_;
  core::Warn warn_;
  core::ClipInfo info_;
  std::size_t position_ = 0;
  std::set<std::string> noted_;
  bool warned_pages_ = false;
};

class MemoryClip final : public FrameDecoder {
 public:
  explicit MemoryClip(core::Clip clip) : clip_(std::move(clip)), source_(clip_) {}
  [[nodiscard]] const core::ClipInfo& info() const override { return clip_.info; }
  cv::Mat next() override { return source_.next(); }
  bool skip() override { return !source_.next().empty(); }
  void rewind() override { source_.rewind(); }

 private:
  core::Clip clip_;
  core::ClipSource source_;
};

}  // namespace

void refuse_slices(const fs::path& path, const ReadOptions& options) {
  if (options.slice || options.brightest_slice)
    throw core::InputError(path.string() + ": it has no slices for --slice");
}

std::unique_ptr<FrameDecoder> decode_video(const fs::path& path, const ReadOptions& options,
                                           const core::Warn& warn) {
  refuse_slices(path, options);
  silence_media_libraries();
  open_file(path);
  std::error_code error;
  if (fs::file_size(path, error) == 0 && !error)
    throw core::IoError("cannot read " + path.string() + ": it is empty");
  return std::make_unique<VideoFileDecoder>(path, warn);
}

std::unique_ptr<FrameDecoder> decode_images(std::vector<fs::path> files, const ReadOptions& options,
                                            const core::Warn& warn) {
  silence_media_libraries();
  refuse_slices(files.front(), options);
  return std::make_unique<ImageDecoder>(std::move(files), options, warn);
}

std::unique_ptr<FrameDecoder> decode_clip(core::Clip clip) {
  return std::make_unique<MemoryClip>(std::move(clip));
}

cv::Mat to_grey(const cv::Mat& frame) {
  if (frame.channels() == 1) return frame;
  cv::Mat grey;
  cv::cvtColor(frame, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

}  // namespace emberfold::io
