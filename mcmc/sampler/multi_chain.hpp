// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/context.hpp"
#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/learning/fit.hpp"
#include "mcmc/sampler/infer.hpp"

namespace emberfold::mcmc {

/// What samples of a clip's posterior tell.
struct MultiChainResult {
  InferResult sampler;
  graph::MotionGraph motion;         ///< the sample whose events agree most with all
  std::vector<graph::Event> events;  ///< pooled, of whatever probability; strokes named as in `motion`
  FitResult fitted;            ///< to a sample of each chain
};

/// From matched readings of a clip to graphs, events and the motion model: a chain from
/// each start, run in the sense of time in which the start was matched, and their samples, all told forwards,
/// pooled. So the clip run backwards has the same two chains from its own readings: the density is one of
/// graphs drawn forwards and its two senses differ where it is in doubt. `backwards`: whether each start was
/// matched backwards in time. Throws core::Cancelled; InputError for no start, or another number of readings.
MultiChainResult sample_chains(const std::vector<graph::MotionGraph>& starts,
                               const std::vector<bool>& backwards, const InferOptions& options,
                               std::uint64_t seed, const core::Context& context);

}  // namespace emberfold::mcmc
