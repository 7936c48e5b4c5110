// SPDX-License-Identifier: Apache-2.0
#include "core/clip.hpp"

#include <opencv2/imgproc.hpp>

namespace emberfold::core {

cv::Mat ClipSource::next() {
  return position_ < clip_.frames.size() ? clip_.frames[position_++].clone() : cv::Mat();
}

Clip read_all(FrameSource& source) {
  Clip clip{source.info(), {}};
  for (cv::Mat frame = source.next(); !frame.empty(); frame = source.next())
    clip.frames.push_back(std::move(frame));
  clip.info.frames = static_cast<std::int64_t>(clip.frames.size());
  return clip;
}

cv::Mat to_levels(const cv::Mat& frame, const ClipInfo& info) {
  cv::Mat levels;
  frame.convertTo(levels, CV_32F, 255.0 / info.white);
  return levels;
}

cv::Mat luma(const cv::Mat& frame, const ClipInfo& info) {
  return luma(to_levels(frame, info));
}

cv::Mat luma(const cv::Mat& levels) {
  if (levels.channels() == 1) return levels;
  cv::Mat grey;
  cv::cvtColor(levels, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

cv::Mat to_bytes(const cv::Mat& levels) {
  cv::Mat bytes;
  levels.convertTo(bytes, CV_8U);
  return bytes;
}

}  // namespace emberfold::core
