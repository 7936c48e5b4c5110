// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/context.hpp"
#include "mcmc/model/motion_model.hpp"
#include "mcmc/simulation/event_statistics.hpp"

namespace emberfold::mcmc {

/// Returns the births a frame of each size class.
std::array<double, kSizeClasses> births_by_size(const MotionModel& model);

/// Sets the births a frame of each size class; the birth map keeps its shape.
/// `otherwise`: shares of the sizes where there are no births.
void set_births(MotionModel& model, const std::array<double, kSizeClasses>& births,
                const std::array<double, kSizeClasses>& otherwise);

/// Calibrates a model's rates so that a clip drawn from it shows the wanted statistics.
/// A clip is simulated while rates are corrected (stochastic approximation of means): births of each size by
/// the numbers of strokes of that size and of all patches, other rates by the frequencies of their events,
/// which are reconciled first (reconcile_event_rates). Rates start at the model's values; a rate of 0 stays
/// 0. Some thousand simulated frames. Stops with the current rates when cancelled.
void calibrate_rates(MotionModel& model, EventStatistics wanted, std::uint64_t seed,
                     const core::Context& context);

}  // namespace emberfold::mcmc
