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

/// Simulates a clip until the model is stationary and returns its statistics.
EventStatistics measure_event_statistics(const MotionModel& model, std::uint64_t seed,
                                         const core::Context& context);

/// Wanted numbers of events a frame, by kind; kinds without a number are free.
using TargetEvents = std::array<std::optional<double>, 6>;

/// Brings a changed model into its stationary state.
/// Rates of the wanted events are corrected until these happen as often as wanted. The density map becomes
/// the simulated one, and the strokes of the last simulated frame become the first frame. Returns a line for
/// every kind of event that misses its number.
std::vector<std::string> calibrate_population(MotionModel& model, const TargetEvents& wanted,
                                              std::uint64_t seed, const core::Context& context);

}  // namespace emberfold::mcmc::detail
