// SPDX-License-Identifier: Apache-2.0
#include "core/io/writing/video_file.hpp"

#include <cerrno>
#include <cmath>
#include <fstream>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "core/error.hpp"
#include "core/io/media_log.hpp"
#include "core/io/scratch.hpp"
#include "core/io/writing/fitted_frame.hpp"
#include "core/io/writing/steady_encoder.hpp"
#include "core/io/writing/video_check.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

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
    if (fs::is_directory(path_)) refuse_to_write(path_, "a folder has this name");
    errno = 0;
    if (!std::ofstream(part_, std::ios::binary | std::ios::trunc))
      refuse_to_write(path_, std::generic_category().message(errno));
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
      refuse_to_write(path_, std::string("FFmpeg offers no ") + (mp4 ? "H.264" : "FFV1") + " encoder for " +
                                 core::size_text(even) + " pixels at this rate");
    }
  }

  ~VideoFileWriter() override {
    video_.release();
    discard();
  }

  void write(const cv::Mat& frame) override {
    if (!video_.isOpened()) throw core::InputError(path_.string() + ": the clip is finished");
    cv::Mat whole = fitted_frame(
        frame, {size_, colour_, "8 bits; a folder of PNG takes 16 too, one of EXR floats"}, path_);
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
      refuse_to_write(path_, full ? "no space is left on the disk"
                                  : "the file did not come out whole; the disk may be full");
    }
    std::error_code error;
    fs::rename(part_, path_, error);
    if (error) refuse_to_write(path_, error.message());
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

}  // namespace

std::unique_ptr<VideoWriter> create_video_file(const fs::path& path, bool mp4, cv::Size size, double fps,
                                               bool colour) {
  return std::make_unique<VideoFileWriter>(path, mp4, size, fps, colour);
}

}  // namespace emberfold::io
