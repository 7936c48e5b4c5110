// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "mcmc/simulation/simulated_strokes.hpp"

namespace emberfold::mcmc::detail {

/// Holds the standard normal noise of a patch, for each coordinate and for the contrast.
struct PatchNoise {
  double x = 0, y = 0, gain = 0;
};

/// Draws each patch's noise of one step from a smooth random field over the frame.
/// The field has unit variance and the correlation exp(−h²/2 range²) at h px. Its values depend on the place
/// at rest and the step. Fields of different steps, and of different `field`, are independent.
std::vector<PatchNoise> draw_noise(const SimulatedStrokes& strokes, const MotionModel& model,
                                   std::uint64_t seed, Purpose purpose, std::uint32_t step,
                                   std::uint32_t field = 0);

}  // namespace emberfold::mcmc::detail
