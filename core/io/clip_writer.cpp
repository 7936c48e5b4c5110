// SPDX-License-Identifier: Apache-2.0
#include "core/io/clip_writer.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "core/error.hpp"
#include "core/io/files.hpp"
#include "core/io/media_log.hpp"
#include "core/io/scratch.hpp"
#include "core/io/steady_encoder.hpp"
#include "core/io/video_check.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& path, const std::string& reason) {
  throw core::IoError("cannot write " + path.string() + ": " + reason);
}

/// The frame as the clip holds it; core::InputError where it does not fit.
cv::Mat fitted(const cv::Mat& frame, const cv::Size& size, bool colour, bool deep, const fs::path& path) {
  const auto refuse = [&](const std::string& what) { throw core::InputError(path.string() + ": " + what); };
  if (frame.size() != size)
    refuse("a frame of " + core::size_text(frame.size()) + " pixels does not fit a clip of " +
           core::size_text(size));
  if (frame.depth() != CV_8U && !(deep && frame.depth() == CV_16U))
    refuse(deep ? "frames need 8 or 16 bits" : "frames need 8 bits; a folder of PNG takes 16 too");
  if (frame.channels() != 1 && frame.channels() != 3) refuse("frames need 1 or 3 channels");
  if (frame.channels() == 3 && !colour) refuse("a frame in colour does not fit a grey clip");
  if (frame.channels() == 3 || !colour) return frame;
  cv::Mat spread;
  cv::cvtColor(frame, spread, cv::COLOR_GRAY2BGR);
  return spread;
}

bool disk_is_full(const fs::path& folder) {
  constexpr std::uintmax_t kLittle = 1 << 16;  // bytes: about what FFmpeg writes at once
  std::error_code error;
  const auto space = fs::space(folder, error);
  return !error && space.available < kLittle;
}

class VideoFileWriter final : public VideoWriter {
 public:
  VideoFileWriter(fs::path path, bool mp4, cv::Size size, double fps, bool colour)
      : path_(std::move(path)),
        part_(scratch_path(path_.parent_path(),
                           mp4 ? ".mp4" : ".avi")),  // the container follows from the extension
        size_(size),
        colour_(colour || mp4),
        mp4_(mp4) {
    if (fs::is_directory(path_)) fail(path_, "a folder has this name");
    errno = 0;
    if (!std::ofstream(part_, std::ios::binary | std::ios::trunc))
      fail(path_, std::generic_category().message(errno));
    silence_media_libraries();
    const int code =
        mp4 ? cv::VideoWriter::fourcc('a', 'v', 'c', '1') : cv::VideoWriter::fourcc('F', 'F', 'V', '1');
    const cv::Size even(size.width + size.width % 2, size.height + size.height % 2);
    const std::vector<int> params{cv::VIDEOWRITER_PROP_IS_COLOR, colour_ ? 1 : 0,
                                  cv::VIDEOWRITER_PROP_HW_ACCELERATION, cv::VIDEO_ACCELERATION_NONE};
    const OneProcessor one_thread;
    const auto clean = clean_memory();
    if (!video_.open(part_.string(), cv::CAP_FFMPEG, code, fps, even, params)) {
      discard();
      fail(path_, std::string("FFmpeg offers no ") + (mp4 ? "H.264" : "FFV1") + " encoder for " +
                      core::size_text(even) + " pixels at this rate");
    }
  }

  ~VideoFileWriter() override {
    video_.release();
    discard();
  }

  void write(const cv::Mat& frame) override {
    if (!video_.isOpened()) throw core::InputError(path_.string() + ": the clip is finished");
    cv::Mat whole = fitted(frame, size_, colour_, false, path_);
    if (size_.width % 2 != 0 || size_.height % 2 != 0)
      cv::copyMakeBorder(whole, whole, 0, size_.height % 2, 0, size_.width % 2, cv::BORDER_REPLICATE);
    const auto clean = clean_memory();
    video_.write(whole);
    ++frames_;
  }

  void finish() override {
    if (!video_.isOpened()) throw core::InputError(path_.string() + ": the clip is finished");
    {
      const auto clean = clean_memory();
      video_.release();
    }
    if (frames_ == 0) throw core::InputError(path_.string() + ": a clip needs at least one frame");
    // OpenCV does not report write errors, so the file is checked.
    if (!video_is_whole(part_) || frames_in_file() != frames_) {
      const bool full = disk_is_full(path_.parent_path());
      discard();
      fail(path_,
           full ? "no space is left on the disk" : "the file did not come out whole; the disk may be full");
    }
    std::error_code error;
    fs::rename(part_, path_, error);
    if (error) fail(path_, error.message());
  }

 private:
  void discard() const {
    std::error_code ignored;
    fs::remove(part_, ignored);
  }

  // For H.264 alone: FFV1 takes 140 bytes a pixel for every frame, and reads none that it did not write.
  [[nodiscard]] std::unique_ptr<CleanMemory> clean_memory() const {
    return mp4_ ? std::make_unique<CleanMemory>() : nullptr;
  }

  [[nodiscard]] long long frames_in_file() const {
    const cv::VideoCapture file(fs::absolute(part_).string(), cv::CAP_FFMPEG);
    return file.isOpened() ? std::llround(file.get(cv::CAP_PROP_FRAME_COUNT)) : 0;
  }

  fs::path path_, part_;
  cv::Size size_;
  bool colour_, mp4_;
  cv::VideoWriter video_;
  long long frames_ = 0;
};

bool is_frame_name(const std::string& name) {
  constexpr std::string_view head = "frame_", tail = ".png";
  return name.size() >= head.size() + 5 + tail.size() && name.starts_with(head) && name.ends_with(tail) &&
         std::all_of(name.begin() + head.size(), name.end() - tail.size(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// Refuses a target that holds, or is, what is not ours to replace.
void check_replaceable(const fs::path& folder) {
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (!fs::exists(status)) return;
  if (!fs::is_directory(status)) fail(folder, "a file has this name");
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (!is_frame_name(entry->path().filename().string()))
      fail(folder, "this folder holds other things than frames (" + entry->path().filename().string() +
                       "); give the name of a new one");
  if (error) fail(folder, error.message());
}

/// Removes a folder of frames; whatever else is in it stays, and the folder with it.
void remove_frames(const fs::path& folder) {
  std::error_code ignored;
  std::vector<fs::path> frames;
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end; entry.increment(ignored))
    if (is_frame_name(entry->path().filename().string())) frames.push_back(entry->path());
  for (const fs::path& frame : frames) fs::remove(frame, ignored);
  fs::remove(folder, ignored);
}

class PngFolderWriter final : public VideoWriter {
 public:
  PngFolderWriter(fs::path path, cv::Size size, bool colour)
      : path_(std::move(path)), part_(scratch_path(path_.parent_path())), size_(size), colour_(colour) {
    check_replaceable(path_);
    std::error_code error;
    fs::create_directory(part_, error);
    if (error) fail(path_, error.message());
  }

  ~PngFolderWriter() override {
    if (!finished_) remove_frames(part_);
  }

  void write(const cv::Mat& frame) override {
    if (finished_) throw core::InputError(path_.string() + ": the clip is finished");
    const cv::Mat whole = fitted(frame, size_, colour_, true, path_);
    if (frames_ == 0) depth_ = whole.depth();
    if (whole.depth() != depth_)
      throw core::InputError(path_.string() + ": frames of 8 and of 16 bits do not mix");
    std::vector<unsigned char> bytes;
    if (!cv::imencode(".png", whole, bytes)) fail(path_, "a frame cannot be encoded as PNG");
    char name[40];
    std::snprintf(name, sizeof name, "frame_%05lld.png", frames_);
    errno = 0;
    std::ofstream out(part_ / name, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) fail(path_, errno != 0 ? std::generic_category().message(errno) : "the disk may be full");
    ++frames_;
  }

  void finish() override {
    if (finished_) throw core::InputError(path_.string() + ": the clip is finished");
    if (frames_ == 0) throw core::InputError(path_.string() + ": a clip needs at least one frame");
    check_replaceable(path_);  // once more: it may have changed since
    const fs::path old = scratch_path(path_.parent_path());
    std::error_code error;
    const bool replaces = fs::exists(path_, error);
    if (replaces) {
      fs::rename(path_, old, error);
      if (error) fail(path_, error.message());
    }
    fs::rename(part_, path_, error);
    if (error) {
      std::error_code ignored;
      if (replaces) fs::rename(old, path_, ignored);
      fail(path_, error.message());
    }
    finished_ = true;
    if (replaces) remove_frames(old);
  }

 private:
  fs::path path_, part_;
  cv::Size size_;
  bool colour_;
  int depth_ = CV_8U;
  long long frames_ = 0;
  bool finished_ = false;
};

}  // namespace

std::unique_ptr<VideoWriter> create_video(const fs::path& path, cv::Size size, double fps, bool colour) {
  const auto refuse = [&](const auto& value, const char* what, const char* allowed) {
    std::ostringstream line;
    line << what << " " << value << " is out of range: " << allowed;
    throw core::InputError(line.str());
  };
  if (size.width < 1 || size.width > 16384) refuse(size.width, "a clip's width", "1 to 16384 pixels");
  if (size.height < 1 || size.height > 16384) refuse(size.height, "a clip's height", "1 to 16384 pixels");
  if (!(fps > 0 && fps <= 1e6)) refuse(fps, "a clip's frame rate", "above 0, at most 1e6 a second");
  if (fps < 1 || fps > 1000) fps = 25;  // players show a slide show of it, or nothing
  if (path.empty()) throw core::InputError("the name of the clip to write is empty");

  fs::path target = fs::absolute(path).lexically_normal();
  if (!target.has_filename()) target = target.parent_path();  // a slash at the end
  if (!fs::is_directory(target.parent_path()))
    fail(path, "there is no folder " + target.parent_path().string());
  std::string extension = target.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension.empty()) return std::make_unique<PngFolderWriter>(target, size, colour);
  if (extension == ".mp4" || extension == ".avi")
    return std::make_unique<VideoFileWriter>(target, extension == ".mp4", size, fps, colour);
  throw core::InputError(
      "cannot write a clip as " + target.extension().string() +
      "; give a name in .mp4 (H.264), .avi (lossless) or without extension (a folder of PNG)");
}

void write_video(const fs::path& path, core::FrameSource& source, int frames, const core::Context& context) {
  const auto& info = source.info();
  if (info.depth != CV_8U)
    throw core::InputError("cannot write " + path.string() + ": its frames must have 8 bits a channel");
  const auto writer = create_video(path, {info.width, info.height}, info.fps, info.channels == 3);
  for (int t = 0; t < frames; ++t) {
    context.check();
    const cv::Mat frame = source.next();
    if (frame.empty()) break;
    writer->write(frame);
    context.report("write", static_cast<double>(t + 1) / frames);
  }
  writer->finish();
}

}  // namespace emberfold::io
