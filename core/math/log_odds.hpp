// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace emberfold::core {

/// Returns the logarithm of the odds of a probability: −∞ of 0, ∞ of 1.
inline double log_odds(double probability) {
  return std::log(probability) - std::log1p(-probability);
}

/// Returns the probability that has these log odds.
inline double from_log_odds(double odds) {
  return 1 / (1 + std::exp(-odds));
}

}  // namespace emberfold::core
