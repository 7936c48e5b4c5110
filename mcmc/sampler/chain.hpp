// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/context.hpp"
#include "mcmc/sampler/moves.hpp"
#include "mcmc/sampler/state_change.hpp"

namespace emberfold::mcmc {

/// Counts how often a move was tried, was possible (and so was evaluated), and was accepted.
struct MoveCount {
  double tried = 0, evaluated = 0, accepted = 0;
  MoveCount& operator+=(const MoveCount& o) {
    return tried += o.tried, evaluated += o.evaluated, accepted += o.accepted, *this;
  }
};

/// Runs one Markov chain over a HiddenGraph. The chain depends on (seed, number), not on threads.
class Chain {
 public:
  Chain(HiddenGraph state, const SamplerParameters& theta, std::uint64_t seed, std::uint32_t number);

  /// Makes `proposals` moves for every candidate, then draws all displacements anew.
  /// Frames that lie six apart are worked on at the same time. Cancelled between two groups of frames.
  void sweep(double proposals, const core::Context& context);
  /// Makes the moves of a sweep.
  void move(double proposals, const core::Context& context);
  /// Draws the displacements of all paths anew.
  void redraw_displacements();

  [[nodiscard]] const HiddenGraph& state() const { return state_; }
  [[nodiscard]] const SamplerParameters& theta() const { return density_.theta(); }
  void set_theta(const SamplerParameters& theta);
  /// Returns the log density of the state.
  /// The moves' gains keep it up to date; after a change of displacements or θ it is computed anew, O(nodes).
  double log_density();
  [[nodiscard]] const std::vector<MoveCount>& counts() const { return counts_; }  ///< by move

 private:
  struct FrameTotals {
    double gain = 0;
    std::vector<MoveCount> counts;
  };
  /// Makes moves from a frame on: those within a few frames, or those over time.
  FrameTotals move_in(int frame, double proposals, bool over_time);

  HiddenGraph state_;
  Density density_;
  FactorCache cache_;
  std::uint64_t seed_;
  std::uint32_t number_, sweeps_ = 0;
  std::optional<double> log_density_;
  std::vector<MoveCount> counts_;
};

}  // namespace emberfold::mcmc
