// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/context.hpp"
#include "mcmc/motion_model.hpp"
#include "mcmc/rates.hpp"

namespace emberfold::mcmc {

/// Makes a synthesized clip hold as many strokes of each size as the learned one: a short clip's births and
/// deaths need not agree, and sizes that nobody saw being born must be. `births`: how many of each size were
/// born in the clip; birth_by_size and the birth map's height are set, by simulating and correcting
/// (stochastic approximation of the counts' means), merges and connects likewise; deaths, splits and
/// disconnects are made rarer where they would happen more often than they were seen. Returns a note where
/// births had to be changed by more than half.
std::vector<std::string> balance(MotionModel& model, const std::array<double, kSizes>& births,
                                 const OperatorCounts& counts, std::uint64_t seed,
                                 const core::Context& context);

}  // namespace emberfold::mcmc
