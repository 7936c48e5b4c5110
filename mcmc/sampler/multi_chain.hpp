// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/context.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/learning/fit.hpp"
#include "mcmc/sampler/infer.hpp"

namespace emberfold::mcmc {

/// Holds what the samples of a clip's posterior give: graphs and the motion model.
struct MultiChainResult {
  InferResult sampler;
  std::vector<graph::MotionGraph> last;  ///< of each chain, its last sample, turned forwards
  FitResult fitted;                      ///< to these
};

/// Samples graphs and the motion model from matched readings of a clip.
/// One chain starts from each reading and runs in the time direction in which that was matched (`backwards`).
/// All samples are turned forwards. So a reversed clip has the same two chains: the density models
/// graphs drawn forwards, and its two directions differ on ambiguous clips. Throws core::Cancelled;
/// core::InputError for no start, or lists of different lengths.
MultiChainResult sample_chains(const std::vector<graph::MotionGraph>& starts,
                               const std::vector<bool>& backwards, const InferOptions& options,
                               std::uint64_t seed, const core::Context& context);

}  // namespace emberfold::mcmc
