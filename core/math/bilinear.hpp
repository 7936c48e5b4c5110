// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include <opencv2/core/mat.hpp>

namespace emberfold::core {

/// The four pixels about a position, clamped to the frame, and its offset from the upper left one.
template <class Number>
struct BilinearPlace {
  int left, top, right, bottom;
  Number u, v;

  BilinearPlace(Number x, Number y, cv::Size size) {
    x = std::clamp(x, Number{0}, static_cast<Number>(size.width - 1));
    y = std::clamp(y, Number{0}, static_cast<Number>(size.height - 1));
    left = static_cast<int>(x), top = static_cast<int>(y);
    right = std::min(left + 1, size.width - 1), bottom = std::min(top + 1, size.height - 1);
    u = x - static_cast<Number>(left), v = y - static_cast<Number>(top);
  }

  /// Interpolates between the values at(row, column) of the rows `top` and `bottom`.
  template <class Row, class At>
  [[nodiscard]] auto between(Row upper, Row lower, const At& at) const {
    return (1 - v) * ((1 - u) * at(upper, left) + u * at(upper, right)) +
           v * ((1 - u) * at(lower, left) + u * at(lower, right));
  }
};

/// Interpolates bilinearly at (x, y) px; positions outside the frame are clamped to it.
/// `values`: CV_32F, one channel.
inline double sample_bilinear(const cv::Mat& values, double x, double y) {
  const BilinearPlace place(x, y, values.size());
  return place.between(values.ptr<float>(place.top), values.ptr<float>(place.bottom),
                       [](const float* row, int column) { return double{row[column]}; });
}

}  // namespace emberfold::core
