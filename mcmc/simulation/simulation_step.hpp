// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "mcmc/simulation/simulated_strokes.hpp"

namespace emberfold::mcmc::detail {

/// Returns the model's first frame with its observed motion, or stationary motion where that is not known.
SimulatedStrokes initial_strokes(const MotionModel& model, std::uint64_t seed);

/// Advances by one frame: motion, drift, ageing, operators.
/// Returns the number of each operator; strokes that left the frame count as deaths.
std::array<int, 6> advance_frame(SimulatedStrokes& strokes, const MotionModel& model, std::uint64_t seed,
                                 std::uint32_t frame);

}  // namespace emberfold::mcmc::detail
