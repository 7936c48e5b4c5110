// SPDX-License-Identifier: Apache-2.0
#include "core/io/reading/missing_pixels.hpp"

#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace emberfold::io {

namespace {

/// Returns 255 where all channels are finite: neither NaN nor infinite.
cv::Mat finite_pixels(const cv::Mat& frame) {
  std::vector<cv::Mat> channels;
  cv::split(frame, channels);
  cv::Mat finite(frame.size(), CV_8U, cv::Scalar(255));
  for (const auto& channel : channels) {
    const cv::Mat size = cv::abs(channel);
    finite &= size <= double{std::numeric_limits<float>::max()};  // false for NaN, too
  }
  return finite;
}

}  // namespace

cv::Mat fill_missing(cv::Mat& frame) {
  if (cv::checkRange(frame)) return {};
  const cv::Mat finite = finite_pixels(frame);
  frame = frame.clone();
  if (cv::countNonZero(finite) == 0) {
    frame = cv::Scalar::all(0);
    return finite;
  }
  // Each pixel gets the label of the nearest finite one; its place is looked up by the label.
  cv::Mat distance, labels;
  cv::distanceTransform(~finite, distance, labels, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::vector<cv::Point> places(frame.total() + 1);
  for (int y = 0; y < frame.rows; ++y)
    for (int x = 0; x < frame.cols; ++x)
      if (finite.at<std::uint8_t>(y, x) != 0) places[static_cast<std::size_t>(labels.at<int>(y, x))] = {x, y};
  const std::size_t bytes = frame.elemSize();
  for (int y = 0; y < frame.rows; ++y)
    for (int x = 0; x < frame.cols; ++x) {
      if (finite.at<std::uint8_t>(y, x) != 0) continue;
      const cv::Point from = places[static_cast<std::size_t>(labels.at<int>(y, x))];
      std::memcpy(frame.ptr(y, x), frame.ptr(from.y, from.x), bytes);
    }
  return finite;
}

}  // namespace emberfold::io
