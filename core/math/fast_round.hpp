// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace emberfold::core {

/// Rounds to the nearest whole number, as std::lround does but without a call.
/// Adds the largest double below ½, so that a value just below a half is not rounded up by the sum.
inline int fast_round(double v) {
  return static_cast<int>(v + std::copysign(0.49999999999999994, v));
}

}  // namespace emberfold::core
