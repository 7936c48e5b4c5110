// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

namespace emberfold::pipeline {

/// What a clip moves in front of.
struct Ground {
  cv::Mat levels;     ///< CV_8U, 1 or 3 channels, of the clip's size
  int tolerance = 0;  ///< grey levels, ≥ 0: what differs from it by no more is the ground
};

/// Estimates the ground of a footage (CV_8U, of one size, at least one frame): the median over time of up to
/// 64 frames; the tolerance is three times the noise of what moves least, at most 8 levels.
Ground still_ground(const std::vector<cv::Mat>& footage);

/// In which light opacities mix colours: levels as displays take them (PNG), or linear light (EXR).
enum class Light { display, linear };

/// Makes the ground transparent: finds the least opacity with which some colour over the ground gives the
/// frame (CV_8U, 1 or 3 channels), less the ground's tolerance. Over black this is the greatest channel. Put
/// over the ground the picture gives the frame but for the tolerance.
/// Returns CV_8UC4 with colours not multiplied by their opacity in `display`, CV_32FC4 with white at 1 and
/// colours multiplied by it in `linear`. Throws core::InputError where the sizes differ. O(pixels).
cv::Mat with_opacity(const cv::Mat& frame, const Ground& ground, Light light);

}  // namespace emberfold::pipeline
