// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

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
/// each start, their samples pooled. Throws Interrupted.
Sampled sample_motion(const std::vector<graph::MotionGraph>& starts, const mcmc::InferOptions& options,
                      std::uint64_t seed, const core::Context& context);

}  // namespace emberfold::apps
