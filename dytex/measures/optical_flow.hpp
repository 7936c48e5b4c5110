// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace emberfold::dytex {

/// Estimates the motion of every pixel from a frame of luma (CV_32F, white = 255) to the next, px a frame,
/// CV_32FC2. At most `most_vectors`: larger frames are reduced first; their motion is in px of the full ones.
/// Farnebäck's method (2003); the same at any number of threads. 0 for frames below 8×8.
cv::Mat optical_flow(const cv::Mat& luma, const cv::Mat& next, double most_vectors = 1 << 16);

}  // namespace emberfold::dytex
