// SPDX-License-Identifier: Apache-2.0
#include "core/io/mask_file.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/clip/masked_source.hpp"
#include "core/io/clip_reader.hpp"
#include "core/io/files.hpp"
#include "core/io/image_files.hpp"
#include "core/io/reading/image_series.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

constexpr double kLabelShare = 0.25;  // of white: half of a smaller brightest value would drop labels

double brightest_of(const cv::Mat& values) {
  double max = 0;
  cv::minMaxLoc(values, nullptr, &max);
  return max;
}

}  // namespace

cv::Mat read_mask(const std::string& path) {
  cv::Mat mask = read_image(path).pixels;
  if (mask.channels() == 3) cv::cvtColor(mask, mask, cv::COLOR_BGR2GRAY);
  const double white = mask.depth() == CV_16U ? 65535 : 255;
  if (mask.depth() != CV_32F && brightest_of(mask) <= kLabelShare * white) mask = mask != 0;
  return mask;
}

cv::Mat read_inside(const std::string& path) {
  ReadOptions reading = ReadOptions().beside();
  reading.grey = true;
  return MaskSource(open_video(path, reading), is_lossy_mask(path)).next();
}

bool is_lossy_mask(const std::string& path) {
  const fs::path file = first_file(path);
  const std::string extension = file.extension().string();
  return is_video_name(file) || extension.starts_with(".jp") || extension.starts_with(".JP");
}

MaskSource::MaskSource(std::unique_ptr<core::FrameSource> values, bool is_lossy)
    : values_(std::move(values)), info_(values_->info()), is_lossy_(is_lossy) {
  info_.channels = 1, info_.depth = CV_8U, info_.white = 255;
}

cv::Mat MaskSource::next() {
  const cv::Mat frame = values_->next();
  if (frame.empty()) return {};
  double threshold = 0;
  if (is_lossy_) {
    brightest_ = std::max(brightest_, brightest_of(frame));
    if (brightest_ > kLabelShare * 255) threshold = brightest_ / 2;
  }
  cv::Mat inside = threshold > 0 ? cv::Mat(frame > threshold) : cv::Mat(frame != 0);
  if (const cv::Mat finite = core::mask_of(*values_); !finite.empty()) inside &= finite;
  return inside;
}

void MaskSource::rewind() {
  values_->rewind();
  brightest_ = 0;
}

}  // namespace emberfold::io
