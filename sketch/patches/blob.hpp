// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "graph/patch.hpp"

namespace emberfold::sketch {

/// Fits a blob to the disc of this radius by least squares. The ramp's direction comes from luma, the levels
/// of each channel in closed form. `levels`: CV_32F, 1 or 3 channels; pixels outside the frame do not count.
/// `reach`: px, 1.5…12. O(reach²).
graph::Patch fit_blob(const cv::Mat& levels, cv::Point centre, double reach);

}  // namespace emberfold::sketch
