// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include "dytex/baselines/star.hpp"

namespace emberfold::dytex::detail {

/// A wave in space under a STAR model: z(t) = first z(t−1) + second z(t−2) + gain a(t).
struct Wave {
  std::complex<double> first, second, gain;
};

/// Calls `take` for 64 × 64 frequencies in space, of which half suffice: the others are conjugates.
inline void for_each_wave(const Star& star, const std::function<void(const Wave&)>& take) {
  constexpr int kSide = 64;
  for (int v = 0; v <= kSide / 2; ++v)
    for (int u = 0; u < kSide; ++u) {
      std::complex<double> sums[3];
      for (std::size_t i = 0; i < star.terms.size(); ++i) {
        const auto& term = star.terms[i];
        const double angle = 2 * std::numbers::pi * (u * term.x + v * term.y) / kSide;
        sums[term.lag] += star.coefficients(static_cast<Eigen::Index>(i)) * std::polar(1.0, angle);
      }
      const auto gain = 1.0 / (1.0 - sums[0]);
      take({sums[1], sums[2], gain});
    }
}

}  // namespace emberfold::dytex::detail
