// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/context.hpp"
#include "graph/events.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/evidence.hpp"

namespace emberfold::mcmc {

struct InferOptions {
  int sweeps = 60;      ///< ≥ 1: of each chain after burn-in
  int burn_in = 40;     ///< ≥ 0: sweeps of each chain in which θ is learned and nothing is kept
  int samples = 12;     ///< 1…sweeps: kept of each chain, evenly spread
  std::uint64_t seed = 1;

  void validate() const;
};

/// One number of every sweep of every chain, burn-in first: for plots and diagnostics.
struct Trace {
  std::string name;                         ///< "log posterior", "patches", "a1", …
  std::vector<std::vector<double>> chains;  ///< [chain][sweep]
};

struct InferResult {
  std::vector<graph::MotionGraph> samples;  ///< of all chains, one chain after another; strokes identified
  int chains = 0;
  int burn_in = 0;  ///< how many of the traces' first values
  std::vector<Trace> traces;
  double proposals = 0;  ///< evaluated, of all chains
  double seconds = 0;    ///< of processor time that they took
  core::Status status = core::Status::done;
};

/// Samples the posterior of graphs and links given the images, a chain from each start (graphs of the same
/// clip, matched), and learns the sampler's θ meanwhile (docs/method.md). The same bytes at any thread count.
InferResult infer(std::span<const graph::MotionGraph> starts, const Evidence& evidence,
                  const InferOptions& options, const core::Context& context = {});

}  // namespace emberfold::mcmc
