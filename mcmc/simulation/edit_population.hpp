// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/context.hpp"
#include "mcmc/model/motion_model.hpp"
#include "mcmc/simulation/event_statistics.hpp"

namespace emberfold::mcmc::detail {

/// What a clip drawn from the model shows when it has run in.
EventStatistics measure_event_statistics(const MotionModel& model, std::uint64_t seed, const core::Context& context);

/// Events a frame that are asked for, by kind; the others happen as they may.
using TargetEvents = std::array<std::optional<double>, 6>;

/// Lets a changed model find the state that it keeps to: rates of events that are asked for are corrected
/// until these happen as often, the density map becomes what is seen, and the strokes of the last simulated
/// frame those to begin with. Returns a line for every event that does not happen as often as asked.
std::vector<std::string> calibrate_population(MotionModel& model, const TargetEvents& wanted, std::uint64_t seed,
                                           const core::Context& context);

}  // namespace emberfold::mcmc::detail
