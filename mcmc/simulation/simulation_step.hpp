// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "mcmc/simulation/simulated_strokes.hpp"

namespace emberfold::mcmc::detail {

/// The model's first frame, moving as it was seen to; settled where that is not known.
SimulatedStrokes initial_strokes(const MotionModel& model, std::uint64_t seed);

/// One frame on: motion, drift, ageing, operators. Returns how many of each operator were carried out;
/// strokes that left the frame are among the deaths.
std::array<int, 6> advance_frame(SimulatedStrokes& strokes, const MotionModel& model, std::uint64_t seed,
                           std::uint32_t frame);

}  // namespace emberfold::mcmc::detail
