// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sketch/detection/curve_tracing.hpp"

namespace emberfold::sketch {

/// Traces the step edges of one scale: the zero set of the second derivative along the gradient, where the
/// gradient is greatest along its own direction (Canny 1986; Lindeberg 1998, eq. 11). By marching squares, so
/// that a curve is closed, or ends at the border or where the gradient falls below `least_gradient` (grey
/// levels per px, > 0). Points are about 0.8 px apart; `contrast` is that of a step that responds best at
/// this scale. Curves of fewer than five points are left out. `index`: of the level, for the points.
/// O(pixels).
std::vector<Chain> trace_edges(const ScaleLevel& level, int index, double least_gradient);

}  // namespace emberfold::sketch
