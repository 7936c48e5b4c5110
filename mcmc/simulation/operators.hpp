// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "mcmc/simulation/simulated_strokes.hpp"

namespace emberfold::mcmc::detail {

/// Draws and carries out the operators of one frame: births, deaths, splits, merges, connects, disconnects,
/// each at its rate, at most one for a stroke. What goes fades first (Particle::leaving) and strokes of which
/// something fades are left alone.
/// Returns how many of each were carried out: births, deaths, splits, merges, connects, disconnects.
std::array<int, 6> apply_operators(SimulatedStrokes& strokes, const MotionModel& model, std::uint64_t seed,
                           std::uint32_t frame);

}  // namespace emberfold::mcmc::detail
