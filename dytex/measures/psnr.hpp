// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace emberfold::dytex {

/// Returns the mean of (a − b)² over all pixels and channels, levels². InputError unless both frames are
/// CV_32F of one size and number of channels.
double mean_square_error(const cv::Mat& a, const cv::Mat& b);

/// dB: no PSNR is above this, so that equal frames have a finite one.
constexpr double kMostPsnr = 100;
/// Returns 10 log₁₀(255² / error), dB, at most kMostPsnr. The error is a mean square one, levels².
double psnr(double mean_square_error);

}  // namespace emberfold::dytex
