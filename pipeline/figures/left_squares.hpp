// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <opencv2/core/mat.hpp>

namespace emberfold::pipeline {

/// Sums of squares, (grey levels)², that descriptions leave of the levels of some pixels.
struct LeftSquares {
  double by_plane = 0;                        ///< an even slope
  std::array<double, 2> by_figures = {0, 0};  ///< a step at the outline of each label, on an even slope
};
/// Fits all where `counts` is not 0. `labels`: 0…1, soft at the outline.
LeftSquares left_squares(const cv::Mat1f& level, const std::array<cv::Mat1f, 2>& labels,
                         const cv::Mat1b& counts);

}  // namespace emberfold::pipeline
