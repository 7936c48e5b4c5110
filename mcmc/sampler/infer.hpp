// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/context.hpp"
#include "core/option_field.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/model/motion_model.hpp"
#include "mcmc/sampler/evidence.hpp"

namespace emberfold::mcmc {

/// Options of infer().
struct InferOptions {
  int sweeps = 20;
  int burn_in = 20;
  bool from_nothing = false;

  /// Returns what checks, help and docstrings say of the fields.
  static auto fields() {
    using core::between, core::kOnOff;
    return std::to_array<core::OptionField<InferOptions>>({
        {"sweeps", &InferOptions::sweeps, "N", between(1, 100000), "Sweeps of each chain after burn-in"},
        {"burn_in", &InferOptions::burn_in, "N", between(1, 100000),
         "Sweeps of each chain before states are kept, in which the parameters are learned"},
        {"from_nothing", &InferOptions::from_nothing, "", kOnOff,
         "Start one more chain without any patch, as a judge of the others"},
    });
  }
  /// Throws core::InputError naming field, value and range.
  void validate() const;
};

/// Holds one number of every sweep of every chain, burn-in first, for plots and diagnostics.
struct Trace {
  std::string name;                         ///< "log posterior", "patches", "a1", "births", …
  std::vector<std::vector<double>> chains;  ///< [chain][sweep]
};

/// Counts a move's proposals over all chains.
struct MoveSum {
  std::string name;
  double tried = 0, evaluated = 0, accepted = 0;
};

/// Holds the samples of the posterior and how the sampler ran.
struct InferResult {
  /// Of all chains, one chain after another, five of each, or as many as there are sweeps; strokes
  /// identified.
  std::vector<graph::MotionGraph> samples;
  int chains = 0;
  int burn_in = 0;  ///< number of the traces' first values
  std::vector<Trace> traces;
  std::vector<MoveSum> moves;
  double proposals = 0;  ///< evaluated, of all chains
  double seconds = 0;    ///< processor time of the proposals
};

/// Samples the posterior of graphs and links given the images, with one chain from each start.
/// The starts are matched graphs of one clip. All chains draw from one density over the same candidates, so
/// that they can be compared; its θ is learned from all of them meanwhile by stochastic approximation EM
/// (docs/method/sampler.md). `learned`, fitted to one of the starts, gives maps, drift, and the first
/// estimate of the displacement's law. The same bytes at any thread count. Throws core::InputError for no
/// start, or starts of different clips. O(sweeps · candidates).
InferResult infer(std::span<const graph::MotionGraph> starts, const MotionModel& learned,
                  const Evidence& evidence, const InferOptions& options, std::uint64_t seed,
                  const core::Context& context = {});

}  // namespace emberfold::mcmc
