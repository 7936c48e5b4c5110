// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "sketch/detection/curve_tracing.hpp"

namespace emberfold::sketch {

/// Holds how given curves are read.
struct GivenCurveLimits {
  double begins;            ///< probability at which a curve begins
  bool only_steps = false;  ///< else luma tells whether a curve is a bright line, a dark line or a step
  int scales = 5;           ///< of the marks, from the frame's finest on, each √2 above the one before
};

/// Traces curves along the crests of a map of probabilities, 0…1. A curve goes on down to half of where it
/// begins; crests of thick and of thin marks alike. What has the greatest contrast along a curve tells its
/// kind and its scale. A point's evidence is −ln(1 − p) over 5 px, at most 7 nats. `space`: of the frame,
/// whose size the map has. O(pixels · levels).
std::vector<Chain> trace_given_curves(const cv::Mat1f& probability, const ScaleSpace& space,
                                      GivenCurveLimits limits);

}  // namespace emberfold::sketch
