// SPDX-License-Identifier: Apache-2.0
#include "core/io/reading/mask_clip.hpp"

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>

#include <opencv2/core.hpp>

#include "core/clip/masked_source.hpp"
#include "core/error.hpp"
#include "core/io/clip_reader.hpp"
#include "core/io/files.hpp"
#include "core/io/reading/image_series.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

constexpr double kLargestLabel = 63;    // below it half of the brightest value would drop labels
constexpr std::size_t kManyValues = 2;  // a mask has one value besides 0, one with a soft edge or labels more
constexpr std::size_t kMostCounted = 256;

/// True where the file's compression may change a 0 into small values.
bool is_lossy(const std::string& name) {
  const fs::path file = first_file(name);
  const std::string extension = file.extension().string();
  return is_video_name(file) || extension.starts_with(".jp") || extension.starts_with(".JP");
}

/// Returns the number of different values that are not 0, up to a limit.
std::size_t count_values(const cv::Mat& frame) {
  cv::Mat values;
  frame.convertTo(values, CV_32F);
  std::set<float> found;
  for (int y = 0; y < values.rows && found.size() < kMostCounted; ++y)
    for (int x = 0; x < values.cols; ++x)
      if (const float value = values.at<float>(y, x); value != 0) found.insert(value);
  return found.size();
}

}  // namespace

MaskClip::MaskClip(const ReadOptions& options, cv::Size size, const core::Warn& warn)
    : name_(options.mask), is_lossy_(is_lossy(name_)) {
  ReadOptions reading = options.beside();
  reading.grey = true, reading.scale = 1, reading.region.reset();
  const ReadOptions part = reading;
  reading.first = 0, reading.last.reset(), reading.every = 1;
  source_ = open_video(name_, reading);
  const auto& info = source_->info();
  if (cv::Size(info.width, info.height) != size)
    throw core::InputError("the mask " + name_ + " is " + core::size_text(info.width, info.height) +
                           " pixels, the clip " + core::size_text(size));
  if (!is_lossy_) note_values(warn);
  if (info.frames == 1) {
    only_ = read();
    if (cv::countNonZero(only_) == 0)
      throw core::InputError("the mask " + name_ + " is black: nothing in it counts");
  } else {
    source_ = open_video(name_, part);
  }
}

cv::Mat MaskClip::read() {
  const cv::Mat frame = source_->next();
  if (frame.empty()) throw core::InputError("the mask " + name_ + " has fewer frames than the clip");
  double threshold = 0;
  if (is_lossy_) {
    double max = 0;
    cv::minMaxLoc(frame, nullptr, &max);
    brightest_ = std::max(brightest_, max);
    if (brightest_ > kLargestLabel) threshold = brightest_ / 2;
  }
  cv::Mat inside = threshold > 0 ? cv::Mat(frame > threshold) : cv::Mat(frame != 0);
  if (const cv::Mat finite = core::mask_of(*source_); !finite.empty()) inside &= finite;
  return inside;
}

void MaskClip::note_values(const core::Warn& warn) {
  if (!warn) return;
  const std::size_t count = count_values(source_->next());
  source_->rewind();
  if (count > kManyValues)
    warn("the mask " + name_ + " has " + (count < kMostCounted ? std::to_string(count) : "many") +
         " different values above 0; all of them count as inside");
}

cv::Mat MaskClip::next() {
  return only_.empty() ? read() : only_;
}

void MaskClip::rewind() {
  source_->rewind();
  brightest_ = 0;
}

}  // namespace emberfold::io
