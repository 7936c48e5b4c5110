// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

// Spatial and temporal information and crease sharpness of frames. Luma is CV_32F, one channel, white = 255.
namespace emberfold::dytex {

/// Returns SI of ITU-T P.910 for one frame of luma: the SD of the Sobel gradient's size over all inner
/// pixels. The recommendation takes the largest over a clip. 0 below 3×3.
double spatial_information(const cv::Mat& luma);
/// Returns TI of ITU-T P.910 for one frame: the SD of its difference from the frame before.
double temporal_information(const cv::Mat& luma, const cv::Mat& before);

/// Steepness of the creases of a frame.
struct Sharpness {
  double gradient = 0;   ///< levels/px: mean steepness
  double sharpness = 0;  ///< 1/px: mean of steepness over the height of the step, whatever its contrast
  int points = 0;        ///< number of points averaged
};
/// Measures the sharpness of creases. These are where the gradient (Sobel, levels/px) is largest along its
/// own direction and at least 1 level/px. The height of the step there is the change of the levels along the
/// gradient, from where they stop falling to where they stop rising, at most 8 px to either side. Only the
/// highest steps count, a fiftieth of the frame's pixels in number: blur does not lower an isolated step, so
/// that a blurred frame is measured at the same steps and not at the few sharp ones it has kept. A step
/// smoothed by a Gaussian of SD s has sharpness 1/(s √2π), less as Sobel smooths, too. Throws InputError for
/// another type. O(pixels).
Sharpness crease_sharpness(const cv::Mat& luma);

}  // namespace emberfold::dytex
