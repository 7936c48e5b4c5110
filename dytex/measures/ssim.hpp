// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace emberfold::dytex {

/// Measures structural similarity, SSIM (Wang, Bovik, Sheikh, Simoncelli 2004, eq. 13), of two frames of
/// luma. Luma is CV_32F, one channel, white = 255. The windows are Gaussian, 11 × 11, SD 1.5, with K 0.01 and
/// 0.03; the result is the mean over all windows inside the frame. Windows of frames below 11 px have the
/// frame's size. 1 for equals, symmetric. Throws InputError for frames of different size or type. O(pixels).
double structural_similarity(const cv::Mat& a, const cv::Mat& b);

}  // namespace emberfold::dytex
