// SPDX-License-Identifier: Apache-2.0
#include "core/io/reading/mask_clip.hpp"

#include <set>
#include <string>
#include <utility>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/io/clip_reader.hpp"
#include "core/io/mask_file.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::io {

namespace {

constexpr std::size_t kManyValues = 2;  // a mask has one value besides 0, one with a soft edge or labels more
constexpr std::size_t kMostCounted = 256;

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

void note_values(core::FrameSource& values, const std::string& name, const core::Warn& warn) {
  const std::size_t count = count_values(values.next());
  values.rewind();
  if (count > kManyValues)
    warn("the mask " + name + " has " + (count < kMostCounted ? std::to_string(count) : "many") +
         " different values above 0; all of them count as inside");
}

}  // namespace

MaskClip::MaskClip(const ReadOptions& options, cv::Size size, const core::Warn& warn) : name_(options.mask) {
  ReadOptions reading = options.beside();
  reading.grey = true, reading.scale = 1, reading.region.reset();
  const ReadOptions part = reading;
  reading.first = 0, reading.last.reset(), reading.every = 1;
  const bool is_lossy = is_lossy_mask(name_);
  auto values = open_video(name_, reading);
  const core::ClipInfo info = values->info();
  if (cv::Size(info.width, info.height) != size)
    throw core::InputError("the mask " + name_ + " is " + core::size_text(info.width, info.height) +
                           " pixels, the clip " + core::size_text(size));
  if (warn && !is_lossy) note_values(*values, name_, warn);
  const bool is_image = info.frames == 1;
  source_ = std::make_unique<MaskSource>(is_image ? std::move(values) : open_video(name_, part), is_lossy);
  if (is_image) {
    only_ = read();
    if (cv::countNonZero(only_) == 0)
      throw core::InputError("the mask " + name_ + " is black: nothing in it counts");
  }
}

cv::Mat MaskClip::read() {
  cv::Mat inside = source_->next();
  if (inside.empty()) throw core::InputError("the mask " + name_ + " has fewer frames than the clip");
  return inside;
}

cv::Mat MaskClip::next() {
  return only_.empty() ? read() : only_;
}

void MaskClip::rewind() {
  source_->rewind();
}

}  // namespace emberfold::io
