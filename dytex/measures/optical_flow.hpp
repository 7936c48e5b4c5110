// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace emberfold::dytex {

/// Where every pixel of a frame of luma (CV_32F, white = 255) goes in the next one, px a frame, CV_32FC2 of
/// at most 2^16 vectors: larger frames are reduced first, their motion told in the pixels of the full ones.
/// Farnebäck's method (2003); the same at any number of threads. 0 for frames below 8×8.
cv::Mat optical_flow(const cv::Mat& luma, const cv::Mat& next);

}  // namespace emberfold::dytex
