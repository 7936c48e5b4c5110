// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace emberfold::io {

/// Replaces non-finite values (NaN, infinity), which registration leaves at borders, by those of the nearest
/// pixel whose channels are all finite, so that no edge arises; by 0 where there is none. `frame`: CV_32F, 1
/// or 3 channels. Returns where it was finite: CV_8U, 255 there; empty: everywhere.
cv::Mat fill_missing(cv::Mat& frame);

}  // namespace emberfold::io
