// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "graph/patch.hpp"

namespace emberfold::mcmc::detail {

/// Rounds to a multiple of 2⁻²⁴, of px or of whatever the number counts.
/// Mathematical libraries differ in the last digit of exp, log, sin or hypot, and strokes that are pushed
/// apart let that grow to another clip within some thousand frames. What a simulation makes with them is
/// rounded before the next frame is made of it, so that the same clip is drawn everywhere.
inline double rounded(double value) {
  constexpr double steps = 1 << 24;
  return std::round(value * steps) / steps;
}
inline graph::Point rounded(graph::Point point) {
  return {rounded(point.x), rounded(point.y)};
}

}  // namespace emberfold::mcmc::detail
