// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

namespace emberfold::io {

/// Reads a mask from an image: CV_8U or CV_16U, one channel (luma of a coloured one), white inside. Throws
/// core::IoError where it cannot be read.
cv::Mat read_mask(const std::string& path);

}  // namespace emberfold::io
