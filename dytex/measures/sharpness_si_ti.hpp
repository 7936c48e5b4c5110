// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

// Measures of single frames and pairs of them. Luma is CV_32F, one channel, white = 255.
namespace emberfold::dytex {

/// The mean of (a − b)² over all pixels and channels. InputError unless both are CV_32F of one size and
/// number of channels.
double mean_square_error(const cv::Mat& a, const cv::Mat& b);

/// What a PSNR is at most: frames that hardly differ have this one.
constexpr double kMostDecibel = 100;
/// 10 log₁₀(255² / error), dB, at most kMostDecibel.
double psnr(double mean_square_error);

/// Structural similarity (Wang, Bovik, Sheikh, Simoncelli 2004, eq. 13) of two frames of luma: Gaussian
/// windows of 11 × 11, SD 1.5, K 0.01 and 0.03, the mean over all windows that lie inside the frame; of
/// frames below 11 px, over windows as large as they are. 1 for equals, symmetric. InputError for unlike
/// frames. O(pixels).
double structural_similarity(const cv::Mat& a, const cv::Mat& b);

/// SI of ITU-T P.910 for one frame of luma: the SD of the Sobel gradient's size over all inner pixels. The
/// recommendation takes the largest over a clip. 0 below 3×3.
double spatial_information(const cv::Mat& luma);
/// TI of ITU-T P.910 for one frame: the SD of its difference from the frame before.
double temporal_information(const cv::Mat& luma, const cv::Mat& before);

/// How steep the lines are along which a frame changes most.
struct Sharpness {
  double gradient = 0;   ///< levels/px: mean steepness
  double sharpness = 0;  ///< 1/px: mean of steepness over the height of the step, whatever its contrast
  int points = 0;        ///< that these are means over
};
/// Creases are where the gradient (Sobel, levels/px) is largest along its own direction and at least 1
/// level/px. The height of the step there is what the levels change by, along the gradient, from where they
/// stop falling to where they stop rising, at most 8 px to either side. The highest steps are taken, as many
/// as a fiftieth of the frame's pixels: blur takes no height from a step that lies alone, so that a blurred
/// frame is measured at the same steps and not at the few sharp ones it has kept. A step smoothed by a
/// Gaussian of SD s has sharpness 1/(s √2π), less as Sobel smooths, too. InputError for another type.
/// O(pixels).
Sharpness crease_sharpness(const cv::Mat& luma);

}  // namespace emberfold::dytex
