// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "mcmc/simulation/simulated_strokes.hpp"

namespace emberfold::mcmc::detail {

/// Applies the operators of one frame: births, deaths, splits, merges, connects, disconnects.
/// Each happens at its rate, at most one to a stroke. Removed patches fade first
/// (SimulatedPatch::frames_left); strokes with fading patches are left alone. Returns the number of each
/// operator, in the order above.
std::array<int, 6> apply_operators(SimulatedStrokes& strokes, const MotionModel& model, std::uint64_t seed,
                                   std::uint32_t frame);

}  // namespace emberfold::mcmc::detail
