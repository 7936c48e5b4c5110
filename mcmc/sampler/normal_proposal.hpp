// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace emberfold::mcmc {

/// Holds the normal distribution that a move draws a displacement from, px.
struct NormalProposal {
  double mean = 0, sd = 1;

  [[nodiscard]] double log_density(double displacement) const {
    constexpr double kHalfLogTwoPi = 0.9189385332046727;
    const double z = (displacement - mean) / sd;
    return -0.5 * z * z - std::log(sd) - kHalfLogTwoPi;
  }
};

}  // namespace emberfold::mcmc
