// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "mcmc/particles.hpp"

namespace emberfold::mcmc::detail {

/// What pushes a particle: standard normal, for each coordinate and for the contrast.
struct Noise {
  double x = 0, y = 0, gain = 0;
};

/// Each particle's noise of one step: a smooth random field about each stroke, of unit variance and
/// correlation exp(−h²/2 range²) at h px, drawn by the stroke's lowest id, the place at rest and the step;
/// independent between strokes and steps. `sides`: neighbours(particles).
std::vector<Noise> draw_noise(const Particles& particles,
                              const std::vector<std::vector<std::uint32_t>>& sides, const MotionModel& model,
                              std::uint64_t seed, Purpose purpose, std::uint32_t step);

}  // namespace emberfold::mcmc::detail
