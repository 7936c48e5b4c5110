// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/motion_graph.hpp"
#include "mcmc/model/motion_model.hpp"
#include "mcmc/sampler/sampler_parameters.hpp"

namespace emberfold::mcmc {

/// Returns the centre of θ's prior: usual numbers for the start's patches, the displacement's law of
/// `learned`.
SamplerParameters prior_parameters(const graph::MotionGraph& start, const MotionModel& learned);

/// Widens the spreads of a learned θ.
/// The patches of a stroke move, turn and flicker together, which the density does not model. Taken as
/// independent, a stroke that jumps would be more likely to die while another one is born.
SamplerParameters widen_spreads(SamplerParameters theta);

}  // namespace emberfold::mcmc
