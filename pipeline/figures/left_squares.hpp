// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace emberfold::pipeline {

/// Sums of squares, (grey levels)², that two descriptions leave of the levels of some pixels.
struct LeftSquares {
  double by_plane = 0;   ///< an even slope
  double by_figure = 0;  ///< a step at the outline of a label, on an even slope
};
/// Fits both where `counts` is not 0. `label`: 0…1, soft at the outline.
LeftSquares left_squares(const cv::Mat1f& level, const cv::Mat1f& label, const cv::Mat1b& counts);

}  // namespace emberfold::pipeline
