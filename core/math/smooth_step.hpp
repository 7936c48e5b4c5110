// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace emberfold::core {

/// Returns 3x² − 2x³, which rises from 0 at x ≤ 0 to 1 at x ≥ 1 without a kink.
inline double smooth_step(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

}  // namespace emberfold::core
