// SPDX-License-Identifier: Apache-2.0
// The formulas of the density, written out once more.
#pragma once

#include <cmath>
#include <numbers>

#include "tests/mcmc/sampler/small_models.hpp"

namespace emberfold::formula {

using mcmc::SamplerParameters;

constexpr double kTight = 1e-10;

inline double normal(double x, double sd) {
  return std::exp(-x * x / (2 * sd * sd)) / (std::sqrt(2 * std::numbers::pi) * sd);
}
/// Density of a turn on either side, normal on (−π/2, π/2).
inline double turned(double x, double sd) {
  return normal(x, sd) / (2 * std::erf(std::numbers::pi / 2 / std::sqrt(2.0) / sd));
}
/// One time in twenty the sketch errs, and what it shows spreads four times wider.
inline double erring(double (*density)(double, double), double x, double sd) {
  return 0.95 * density(x, sd) + 0.05 * density(x, 4 * sd);
}
inline double log_contrast(double contrast) {
  return std::log(1 + std::abs(contrast));
}
/// Variance of an AR(2) from its lag-one correlation: γ₀(1 − a₁ρ₁ − a₂ρ₂) = noise².
inline double stationary(const SamplerParameters& t) {
  const double rho1 = t.displacement.a1 / (1 - t.displacement.a2),
               rho2 = t.displacement.a1 * rho1 + t.displacement.a2;
  return t.displacement.noise * t.displacement.noise /
         (1 - t.displacement.a1 * rho1 - t.displacement.a2 * rho2);
}
inline double begun(const SamplerParameters& t, int frame, double contrast, std::size_t kind) {
  return t.birth[frame == 0 ? 0 : 1] / (2 * std::numbers::pi) *
         normal(log_contrast(contrast) - t.new_contrast, t.new_contrast_sd) * t.kinds[kind];
}
/// Density of a patch of the same kind and contrast, grown at (`along`, `side`) and turned by `turn`.
inline double grown(const SamplerParameters& t, double along, double side, double turn) {
  const double line = 0.5 * (normal(along - t.step, t.step_sd) + normal(along + t.step, t.step_sd)) *
                      normal(side, t.side_sd) * turned(turn, t.bend_sd);
  const double r = t.branch_reach;
  const double anywhere =
      std::hypot(along, side) <= r ? 1 / (std::numbers::pi * r * r) / (2 * std::numbers::pi) : 0;
  return ((1 - t.branch) * line + t.branch * anywhere) * normal(0, t.grown_contrast_sd) * (1 - t.other_kind);
}
/// The logarithm of the chance that no stroke more begins.
inline double empty_frames(const SamplerParameters& t, double area, int frames) {
  return -t.birth[0] * area - (frames - 1) * t.birth[1] * area;
}
inline double chance(const SamplerParameters& t, std::size_t degree, std::size_t neighbour_outcome,
                     mcmc::Outcome what, bool can_merge, bool border = false) {
  const auto& row = t.outcome[mcmc::outcome_context(degree, border, neighbour_outcome)];
  return row[static_cast<std::size_t>(what)] / (can_merge ? 1 : 1 - row[3]);
}

inline SamplerParameters theta() {
  auto t = test::even_theta();
  t.new_contrast = 3.1;
  return t;
}

}  // namespace emberfold::formula
