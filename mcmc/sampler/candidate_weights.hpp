// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/context.hpp"
#include "mcmc/model/motion_model.hpp"
#include "mcmc/sampler/evidence.hpp"
#include "mcmc/sampler/hidden_graph.hpp"

namespace emberfold::mcmc {

/// Gives all candidates the evidence of the images. What a sketch shows although it does not pay alone holds
/// a line together, or is where lines meet, which no profile shows: it counts 0. Edges that the state has
/// now, the sketch's, are worth kEdge nats, others cost as much. Frames in parallel.
void weigh_candidates(HiddenGraph& state, const Evidence& evidence, const core::Context& context = {});

constexpr double kEdgeEvidence = 20;

/// What maps learned before say of the candidates' places: births, deaths and drift.
void apply_maps(HiddenGraph& state, const MotionModel& model);

}  // namespace emberfold::mcmc
