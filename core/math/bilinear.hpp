// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include <opencv2/core/mat.hpp>

namespace emberfold::core {

/// Interpolates bilinearly at (x, y) px; positions outside the frame are clamped to it.
/// `values`: CV_32F, one channel.
inline double sample_bilinear(const cv::Mat& values, double x, double y) {
  x = std::clamp(x, 0.0, values.cols - 1.0);
  y = std::clamp(y, 0.0, values.rows - 1.0);
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const int right = std::min(left + 1, values.cols - 1), bottom = std::min(top + 1, values.rows - 1);
  const double u = x - left, v = y - top;
  const float *above = values.ptr<float>(top), *below = values.ptr<float>(bottom);
  return (1 - v) * ((1 - u) * double{above[left]} + u * double{above[right]}) +
         v * ((1 - u) * double{below[left]} + u * double{below[right]});
}

}  // namespace emberfold::core
