// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

#include "core/error.hpp"
#include "core/text/size_text.hpp"

/// Checks that several measures of frames use.
namespace emberfold::dytex::detail {

/// Throws InputError unless the frame is luma: CV_32F, one channel, not empty.
inline void check_luma(const cv::Mat& luma, const char* measure) {
  if (luma.empty() || luma.type() != CV_32FC1)
    throw core::InputError(std::string(measure) + ": a frame must be luma, one channel of 32-bit floats");
}

/// Throws InputError unless both frames have one size.
inline void check_alike(const cv::Mat& a, const cv::Mat& b, const char* measure) {
  if (a.size() != b.size())
    throw core::InputError(std::string(measure) + ": the frames are " + core::size_text(a.size()) + " and " +
                           core::size_text(b.size()) + "; allowed is one size");
}

}  // namespace emberfold::dytex::detail
