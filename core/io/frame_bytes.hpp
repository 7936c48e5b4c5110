// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace emberfold::io {

/// Compresses a frame (CV_8U, 1 or 3 channels) by JPEG at quality 95, colours at full resolution.
/// About a tenth of its bytes; levels differ by some 1 to 2 (RMS).
std::vector<std::uint8_t> encode_frame(const cv::Mat& frame);

/// Decompresses a frame of encode_frame. Throws core::IoError where the bytes are no frame of that size.
cv::Mat decode_frame(std::span<const std::uint8_t> bytes, cv::Size size, int channels);

}  // namespace emberfold::io
