// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <opencv2/core/mat.hpp>

namespace emberfold::pipeline {

/// Points to a frame, CV_8U of 1 or 3 channels, and to the motion from it to the next (footage_motion).
struct MovingFrame {
  const cv::Mat *frame, *motion;
};

/// Draws a frame whose pixels show the times `begin` + offsets, counted from frames[0] on: 0 to less than
/// their number less 1.
/// Between two frames the nearer one is moved along the motion, and mixed with the other one half way
/// between; pixels that move by less than 0.1 px are copied. `offsets`: frames, one per pixel. O(pixels).
cv::Mat draw_between(std::span<const MovingFrame> frames, double begin, const cv::Mat1f& offsets);

}  // namespace emberfold::pipeline
