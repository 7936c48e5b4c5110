// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "graph/patch.hpp"

namespace emberfold::sketch {

/// Holds how strongly a profile shows in a frame, and where.
struct Amplitude {
  double value = 1;  ///< 1 as strongly as the patch has it, 0 not at all, below 0 the other way round
  double slip = 0;   ///< px across the patch, along its normal, at which it shows most
};

/// Measures how strongly a patch's profile shows in a frame.
/// The coefficient of the profile in a least-squares fit of profile and constant level to the frame, 5 px
/// along the patch, at the place within `slip` px across it where it is largest. Colours are projected on the
/// difference of levels that the patch has. `levels`: CV_32F or CV_8U, 1 or 3 channels, white = 255; outside,
/// the border's levels count. O(pixels of the profile).
Amplitude measure_amplitude(const cv::Mat& levels, const graph::Patch& patch, double slip);

}  // namespace emberfold::sketch
