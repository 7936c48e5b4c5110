// SPDX-License-Identifier: Apache-2.0
#include "pipeline/frame_motion.hpp"

#include <algorithm>

namespace emberfold::pipeline {

using graph::Point;

Point sample_motion(const cv::Mat& motion, cv::Size size, Point p) {
  const auto place = [](double at, int full, int count) {
    return std::clamp((at + 0.5) * count / full - 0.5, 0.0, count - 1.0);
  };
  const double x = place(p.x, size.width, motion.cols), y = place(p.y, size.height, motion.rows);
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const int right = std::min(left + 1, motion.cols - 1), below = std::min(top + 1, motion.rows - 1);
  const double u = x - left, v = y - top;
  const auto at = [&](int row, int column) {
    const auto& value = motion.at<cv::Vec2f>(row, column);
    return Point{double{value[0]}, double{value[1]}};
  };
  return (at(top, left) * (1 - u) + at(top, right) * u) * (1 - v) +
         (at(below, left) * (1 - u) + at(below, right) * u) * v;
}

}  // namespace emberfold::pipeline
