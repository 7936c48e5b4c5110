// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/starts.hpp"
#include "core/context.hpp"
#include "graph/events.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/fit.hpp"
#include "mcmc/infer.hpp"

namespace emberfold::apps {

/// What samples of a clip's posterior tell.
struct Sampled {
  mcmc::InferResult sampler;
  graph::MotionGraph motion;         ///< the sample whose events agree most with all
  std::vector<graph::Event> events;  ///< pooled, of whatever probability; strokes named as in `motion`
  mcmc::FitResult fitted;            ///< to a sample of each chain
};

/// From matched readings of a clip (apps/starts.hpp) to graphs, events and the motion model: a chain from
/// each start, run in the sense of time in which the start was matched, and their samples, all told forwards,
/// pooled. So the clip run backwards has the same two chains from its own readings: the density is one of
/// graphs drawn forwards and its two senses differ where it is in doubt. `read`: how each start reads the
/// clip. Throws Interrupted; InputError for no start, or another number of readings.
Sampled sample_motion(const std::vector<graph::MotionGraph>& starts, const std::vector<StartReading>& read,
                      const mcmc::InferOptions& options, std::uint64_t seed, const core::Context& context);

}  // namespace emberfold::apps
