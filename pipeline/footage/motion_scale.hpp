// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"

namespace emberfold::pipeline {

/// Holds the speed of a footage, and how well its motion explains it.
struct MotionScale {
  cv::Mat1b moves;   ///< moving_pixels of the footage
  double speed = 0;  ///< px per frame: upper quartile where pixels change
  /// Mean error of frames drawn half way between their neighbours, divided by the mean difference to the
  /// previous frame; ≥ 0, 0 without motion.
  double between_error = 0;
};

/// Returns where pixels of a footage move: 255 where their SD over time is above 6 levels, else 0.
cv::Mat1b moving_pixels(const std::vector<cv::Mat>& footage);

/// Measures speed and error at up to 16 places of a footage of at least two frames, CV_8U. Throws
/// core::Cancelled.
MotionScale measure_motion_scale(const std::vector<cv::Mat>& footage, const core::Context& context);

}  // namespace emberfold::pipeline
