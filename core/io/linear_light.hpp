// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace emberfold::io {

/// Returns the linear light of an sRGB value, both 0…1 (IEC 61966-2-1).
double linear_light(double value);

/// Returns a picture (CV_8U or CV_16U, 1, 3 or 4 channels, the fourth an opacity) in linear light, CV_32F
/// with white at 1; colours are multiplied by their opacity, as OpenEXR wants it.
cv::Mat to_linear_light(const cv::Mat& picture);

}  // namespace emberfold::io
