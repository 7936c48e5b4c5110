// SPDX-License-Identifier: Apache-2.0
#include "core/io/reading/mask_clip.hpp"

#include <algorithm>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/io/clip_reader.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::io {

MaskClip::MaskClip(const ReadOptions& options, cv::Size size) : name_(options.mask) {
  ReadOptions reading = options.beside();
  reading.grey = true, reading.scale = 1, reading.region.reset();
  const ReadOptions part = reading;
  reading.first = 0, reading.last.reset(), reading.every = 1;
  source_ = open_video(name_, reading);
  const auto& info = source_->info();
  if (cv::Size(info.width, info.height) != size)
    throw core::InputError("the mask " + name_ + " is " + core::size_text(info.width, info.height) +
                           " pixels, the clip " + core::size_text(size));
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
  double most = 0;
  cv::minMaxLoc(frame, nullptr, &most);
  brightest_ = std::max(brightest_, most);
  if (brightest_ <= 0) return cv::Mat::zeros(frame.size(), CV_8U);
  return frame > brightest_ / 2;
}

cv::Mat MaskClip::next() {
  return only_.empty() ? read() : only_;
}

void MaskClip::rewind() {
  source_->rewind();
  brightest_ = 0;
}

}  // namespace emberfold::io
