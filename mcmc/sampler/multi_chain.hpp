// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/context.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/learning/fit.hpp"
#include "mcmc/sampler/infer.hpp"

namespace emberfold::mcmc {

/// Holds what the samples of a clip's posterior give: graphs and the motion model.
struct MultiChainResult {
  InferResult sampler;
  std::vector<graph::MotionGraph> last;  ///< of each chain from a start, its last sample
  FitResult fitted;                      ///< to these
};

/// Samples graphs and the motion model from matched readings of a clip, with one chain from each.
/// Throws core::Cancelled; core::InputError for no start, or starts of different clips.
MultiChainResult sample_chains(std::span<const graph::MotionGraph> starts, const InferOptions& options,
                               std::uint64_t seed, const core::Context& context);

}  // namespace emberfold::mcmc
