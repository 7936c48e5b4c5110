// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/sampler_parameters.hpp"

#include <cmath>
#include <numeric>
#include <string>

#include "core/error.hpp"

namespace emberfold::mcmc {

namespace {

void check(bool holds, const std::string& name, double value, const char* allowed) {
  if (!holds || !std::isfinite(value))
    throw core::InputError("theta: " + name + " is " + std::to_string(value) + ", allowed is " + allowed);
}
void check_chance(const std::string& name, double value) {
  check(value > 0 && value < 1, name, value, "a number between 0 and 1");
}
void check_positive(const std::string& name, double value) {
  check(value > 0, name, value, "a finite number above 0");
}

}  // namespace

void validate(const SamplerParameters& theta) {
  for (const auto& chances : theta.outcome) {
    for (const double p : chances) check_chance("outcome", p);
    const double sum = std::accumulate(chances.begin(), chances.end(), 0.0);
    check(std::abs(sum - 1) < 1e-9, "the sum of an outcome's chances", sum, "1");
  }
  for (std::size_t k = 0; k < kCloseness; ++k) {
    for (const auto& chances : theta.join) check_chance("join", chances[k]);
    check_chance("close", theta.close[0][k]), check_chance("close", theta.close[1][k]);
  }
  check_chance("split_more", theta.split_more);
  check_chance("branch", theta.branch), check_chance("other_kind", theta.other_kind);
  for (const double p : theta.kinds) check_chance("kinds", p);
  for (const double r : theta.birth) check_positive("birth", r);
  for (const double r : theta.growth) check_positive("growth", r);
  check_positive("first_growth", theta.first_growth);
  check_positive("across", theta.across), check_positive("along", theta.along);
  check_positive("turn", theta.turn), check_positive("flicker", theta.flicker);
  check_positive("split_spread", theta.split_spread);
  check_positive("new_contrast_sd", theta.new_contrast_sd);
  check_positive("step", theta.step), check_positive("step_sd", theta.step_sd);
  check_positive("side_sd", theta.side_sd), check_positive("bend_sd", theta.bend_sd);
  check_positive("grown_contrast_sd", theta.grown_contrast_sd);
  check_positive("branch_reach", theta.branch_reach);
  check_positive("the noise of the sway", theta.displacement.noise);
  check(spectral_radius(theta.displacement) < 1, "the sway's spectral radius",
        spectral_radius(theta.displacement), "a number below 1");
}

SamplerParameters default_parameters(double patches, double area) {
  SamplerParameters theta;
  for (std::size_t degree = 0; degree < kDegrees; ++degree)
    for (std::size_t border = 0; border < 2; ++border)
      for (std::size_t neighbour_outcome = 0; neighbour_outcome < kNeighbourOutcomes; ++neighbour_outcome) {
        const double alone = degree == 0 ? 0.2 : degree == 1 ? 0.1 : 0.02;
        const double death = neighbour_outcome == 2 ? 0.4 : neighbour_outcome == 1 ? alone / 2 : alone;
        const double split = 0.002, merge = 0.002;
        theta.outcome[outcome_context(degree, border > 0, neighbour_outcome)] = {
            death, 1 - death - split - merge, split, merge};
      }
  const double strokes = std::max(patches, 1.0) / 10 / std::max(area, 1.0);
  theta.birth = {strokes, strokes * 0.05};
  theta.growth = {0.1, 0.02, 0.02, 1.6};
  constexpr std::array<double, kCloseness> staying = {0.99, 0.97, 0.97, 0.95, 0.9, 0.9};
  constexpr std::array<double, kCloseness> near = {0.9, 0.5, 0.1, 0.1, 0.1, 0.1};
  constexpr std::array<double, kCloseness> meeting = {0.2, 0.05, 0.02, 0.01, 0.003, 0.003};
  theta.join = {meeting, near, staying};
  theta.close = {meeting, meeting};
  return theta;
}

}  // namespace emberfold::mcmc
