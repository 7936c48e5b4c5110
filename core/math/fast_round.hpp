// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace emberfold::core {

/// The nearest whole number, as std::lround has it, without a call: half less the last bit, so that what is
/// just below a half is not rounded up by the sum.
inline int fast_round(double v) {
  return static_cast<int>(v + std::copysign(0.49999999999999994, v));
}

}  // namespace emberfold::core
