// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace emberfold::figures {

/// dB, of levels against an 8-bit frame.
double psnr(const cv::Mat1b& frame, const cv::Mat& levels);

/// Returns the share of the mask's pixels that are not 0.
double share(const cv::Mat& mask);

/// Canny's edges, three pixels thick, with the thresholds at which they cover as nearly this share as can be.
cv::Mat canny_band(const cv::Mat1b& frame, double share);

/// This share of the pixels, drawn at random; always the same for one size.
cv::Mat random_mask(cv::Size size, double share);

}  // namespace emberfold::figures
