// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

namespace emberfold::pipeline {

/// The static background of a clip.
struct Ground {
  cv::Mat levels;     ///< CV_8U, 1 or 3 channels, of the clip's size
  int tolerance = 0;  ///< grey levels, ≥ 0: smaller differences count as background
};

/// Estimates the background of a footage (CV_8U, of one size, at least one frame): the median over time of up
/// to 64 frames. The tolerance is three times the noise of the least moving pixels, at most 8 levels.
Ground still_ground(const std::vector<cv::Mat>& footage);

/// Names the light in which opacities mix colours: display levels (PNG) or linear light (EXR).
enum class Light { display, linear };

/// Makes the background transparent.
/// Finds the least opacity at which some colour over the background gives the frame (CV_8U, 1 or 3 channels)
/// after subtracting the tolerance. Over black this is the greatest channel. Over the background the result
/// gives the frame up to the tolerance. Returns CV_8UC4 with straight alpha in `display`, CV_32FC4 with white
/// at 1 and premultiplied alpha in `linear`. Throws core::InputError where the sizes differ. O(pixels).
cv::Mat with_opacity(const cv::Mat& frame, const Ground& ground, Light light);

}  // namespace emberfold::pipeline
