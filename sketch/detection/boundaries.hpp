// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace emberfold::sketch {

/// Computes, for each pixel, how likely the boundary of a thing runs through it, as people draw boundaries in
/// photographs: 0…1. Small and large half discs to both sides are compared in their histograms of brightness
/// and of texture, in 8 directions; the greatest counts. A line has the same on both sides, so has texture:
/// both are no boundaries. `levels`: CV_32F, white = 255, 1 or 3 channels; of three the axes of colour are
/// compared too. O(pixels), about 300 times the cost of a Gaussian.
cv::Mat1f find_boundaries(const cv::Mat& levels);

}  // namespace emberfold::sketch
