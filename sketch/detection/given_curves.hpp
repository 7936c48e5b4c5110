// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "sketch/detection/curve_tracing.hpp"

namespace emberfold::sketch {

/// Traces curves along the crests of a map of probabilities, 0…1, that come from elsewhere. A curve begins
/// where it reaches `begins` and goes on down to half of that; crests of thick and of thin marks alike. Luma
/// tells whether a curve is a bright line, a dark line or a step, whichever has the greatest contrast along
/// it, and its scale. A point's evidence is −ln(1 − p) over 5 px, at most 7 nats. `space`: of the frame,
/// whose size the map has. O(pixels · levels).
std::vector<Chain> trace_given_curves(const cv::Mat1f& probability, const ScaleSpace& space, double begins);

}  // namespace emberfold::sketch
