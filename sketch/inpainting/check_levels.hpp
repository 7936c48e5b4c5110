// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace emberfold::sketch {

/// Throws core::InputError, in the name of `caller`, unless levels are CV_32FC1 or CV_32FC3 of at least 1 × 1
/// and the mask is CV_8UC1 of their size.
void check_levels_and_mask(const char* caller, const cv::Mat& levels, const cv::Mat& mask);

}  // namespace emberfold::sketch
