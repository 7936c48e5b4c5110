// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "mcmc/simulation/simulated_strokes.hpp"

namespace emberfold::mcmc::detail {

/// What pushes a patch: standard normal, for each coordinate and for the contrast.
struct PatchNoise {
  double x = 0, y = 0, gain = 0;
};

/// Each patch's noise of one step: a smooth random field over the frame, of unit variance and correlation
/// exp(−h²/2 range²) at h px, drawn by the place at rest and the step; independent between steps, and between
/// fields of another number `of`.
std::vector<PatchNoise> draw_noise(const SimulatedStrokes& strokes, const MotionModel& model, std::uint64_t seed,
                              Purpose purpose, std::uint32_t step, std::uint32_t field = 0);

}  // namespace emberfold::mcmc::detail
