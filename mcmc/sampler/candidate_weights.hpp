// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/context.hpp"
#include "mcmc/model/motion_model.hpp"
#include "mcmc/sampler/evidence.hpp"
#include "mcmc/sampler/hidden_graph.hpp"

namespace emberfold::mcmc {

/// Sets the evidence of all candidate patches and edges.
/// Patches: the images' gain in nats, at least 0. A patch of the sketch that does not pay alone holds a line
/// together, or lies where lines meet, which no profile shows. Edges: kEdgeEvidence nats for those that the
/// state has now (the sketch's), −kEdgeEvidence for others. Frames in parallel.
void weigh_candidates(HiddenGraph& state, const Evidence& evidence, const core::Context& context = {});

/// Evidence of an edge of the sketch, nats.
constexpr double kEdgeEvidence = 20;

/// Sets the birth, death and drift of every candidate's place from the maps of a learned model.
void apply_maps(HiddenGraph& state, const MotionModel& model);

}  // namespace emberfold::mcmc
