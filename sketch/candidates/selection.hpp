// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "sketch/detection/curve_tracing.hpp"
#include "sketch/detection/scale_space.hpp"

namespace emberfold::sketch {

/// Holds the settings of select_curves().
struct SelectionOptions {
  double noise = 1;             ///< grey levels, SD of the pixels
  double visible_contrast = 6;  ///< grey levels: a fainter step is never drawn
  double exchange_rate = 1;     ///< nats that the image's code must shrink by for each nat of description
};

/// Chooses the curves that shorten the code of the image most.
/// Pixels without a curve are coded as an even ramp with Gaussian residuals, a curve as a blurred step or bar
/// whose levels change from section to section; n pixels cost ½ n ln(residual² + noise²) nats (Rissanen 1978;
/// Guo, Zhu & Wu 2007). `lines` come first, then the step edges of each scale, fine to coarse, where what was
/// chosen before leaves something to explain; last, what others explain as well is dropped again, so that a
/// wide shape keeps its outline and a narrow one its axis. Returns parts of the given curves.
/// O(points · pixels about a point).
std::vector<Chain> select_curves(std::vector<Chain> lines, std::vector<std::vector<Chain>> edges,
                                 const ScaleSpace& space, const cv::Mat1f& luma,
                                 const SelectionOptions& options);

}  // namespace emberfold::sketch
