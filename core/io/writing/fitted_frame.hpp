// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <opencv2/core/mat.hpp>

namespace emberfold::io {

/// Formats that the frames of a written clip may have.
struct FrameFormat {
  cv::Size size;
  bool colour = true;
  std::string depths;  ///< in words
  bool sixteen_bits = false, floats = false, opacity = false;
};

/// Converts a frame to this format, a grey one in a colour clip to three channels. Throws core::InputError,
/// naming the clip, where it does not fit.
cv::Mat fitted_frame(const cv::Mat& frame, const FrameFormat& format, const std::filesystem::path& clip);

/// Throws core::IoError that says what cannot be written, and why.
[[noreturn]] void refuse_to_write(const std::filesystem::path& clip, const std::string& reason);

}  // namespace emberfold::io
