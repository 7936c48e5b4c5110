// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/motion_graph.hpp"
#include "mcmc/model/motion_model.hpp"
#include "mcmc/sampler/sampler_parameters.hpp"

namespace emberfold::mcmc {

/// About what θ is learned: usual numbers for as many patches as the start has, and the displacement of `learned`.
SamplerParameters prior_parameters(const graph::MotionGraph& start, const MotionModel& learned);

/// The patches of a stroke move, turn and flicker together, which the density does not know: taken as
/// independent, a stroke that jumps would rather be dead and another one born. So what spreads they have are
/// learned, and then taken wider.
SamplerParameters widen_spreads(SamplerParameters theta);

}  // namespace emberfold::mcmc
