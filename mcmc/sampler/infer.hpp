// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/context.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/model/motion_model.hpp"
#include "mcmc/sampler/evidence.hpp"

namespace emberfold::mcmc {

struct InferOptions {
  int sweeps = 10;       ///< 1…100000: of each chain after burn-in
  int burn_in = 10;      ///< 1…100000: sweeps of each chain in which θ is learned and nothing is kept
  int samples = 5;       ///< 1…sweeps: kept of each chain, evenly spread
  double proposals = 8;  ///< 0.01…1000: moves for every candidate patch in a sweep
  int tempering_levels = 1;  ///< 1…16: of each chain's ladder of tempered ones, evidence to the power 1, ½, ¼ …

  void validate() const;
};

/// One number of every sweep of every chain, burn-in first: for plots and diagnostics.
struct Trace {
  std::string name;                         ///< "log posterior", "patches", "a1", …
  std::vector<std::vector<double>> chains;  ///< [chain][sweep]
};

/// What became of a move's proposals, of all chains.
struct MoveSum {
  std::string name;
  double tried = 0, evaluated = 0, accepted = 0;
};

struct InferResult {
  std::vector<graph::MotionGraph> samples;  ///< of all chains, one chain after another; strokes identified
  int chains = 0;
  int burn_in = 0;  ///< how many of the traces' first values
  std::vector<Trace> traces;
  std::vector<MoveSum> moves;
  double proposals = 0;  ///< evaluated, of all chains
  double seconds = 0;    ///< of processor time that they took
};

/// Samples the posterior of graphs and links given the images, a chain from each start (graphs of the same
/// clip, matched), and learns the sampler's θ meanwhile by stochastic approximation (docs/method/sampler.md).
/// `learned`: fitted to one of the starts: maps, drift, and where the displacement's learning begins. The same bytes
/// at any thread count. InputError for no start, or starts of different clips. O(sweeps · candidates).
InferResult infer(std::span<const graph::MotionGraph> starts, const MotionModel& learned,
                  const Evidence& evidence, const InferOptions& options, std::uint64_t seed,
                  const core::Context& context = {});

}  // namespace emberfold::mcmc
