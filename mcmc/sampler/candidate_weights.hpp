// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "core/context.hpp"
#include "mcmc/model/motion_model.hpp"
#include "mcmc/sampler/evidence.hpp"
#include "mcmc/sampler/hidden_graph.hpp"

namespace emberfold::mcmc {

/// Sets the evidence of all candidate patches and edges, the same in all `states` (of the same candidates).
/// Patches: kGainShare of the images' gain in nats, at most kMostGain in size. The gain takes the pixels of a
/// patch as independent and its profile as right, so that it says far too much; a composite likelihood is
/// tempered. Edges: kEdgeEvidence log (n + ½)/(m + ½), with n of the states joining the two patches and m
/// having both apart. Frames in parallel.
void weigh_candidates(std::span<HiddenGraph> states, const Evidence& evidence,
                      const core::Context& context = {});

constexpr double kGainShare = 0.1;
constexpr double kMostGain = 12;     ///< nats
constexpr double kEdgeEvidence = 8;  ///< nats

/// Sets the birth, death and drift of every candidate's place from the maps of a learned model.
void apply_maps(HiddenGraph& state, const MotionModel& model);

}  // namespace emberfold::mcmc
