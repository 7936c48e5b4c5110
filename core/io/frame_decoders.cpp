// SPDX-License-Identifier: Apache-2.0
#include "core/io/frame_decoders.hpp"

#include <optional>
#include <set>
#include <string>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/io/image_files.hpp"
#include "core/io/media_log.hpp"
#include "core/io/reading/missing_numbers.hpp"
#include "core/io/tiff/axes.hpp"
#include "core/io/tiff_pages.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

void report(const core::Warn& warn, const std::string& line) {
  if (warn) warn(line);
}

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
