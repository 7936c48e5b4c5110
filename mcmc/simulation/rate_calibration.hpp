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

/// Births a frame, of each size.
std::array<double, kSizeClasses> births_by_size(const MotionModel& model);

/// Sets them; the birth map keeps its shape. `otherwise`: shares where there are none.
void set_births(MotionModel& model, const std::array<double, kSizeClasses>& births,
                const std::array<double, kSizeClasses>& otherwise);

/// Makes a clip drawn from the model show what is wanted: a clip is simulated on and on while the births of
/// each size are corrected by how many strokes of that size there are and how many patches in all, and the
/// other rates by how often their events happen (stochastic approximation of means; the events' frequencies
/// are reconciled first). Rates begin where the model has them; one of 0 stays. Some thousand simulated
/// frames; stops where it is when cancelled.
void calibrate_rates(MotionModel& model, EventStatistics wanted, std::uint64_t seed, const core::Context& context);

}  // namespace emberfold::mcmc
