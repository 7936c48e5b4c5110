// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/context.hpp"
#include "mcmc/sampler/moves.hpp"
#include "mcmc/sampler/state_change.hpp"

namespace emberfold::mcmc {

/// How often a move was tried, could be made (and so was evaluated), and was accepted.
struct MoveCount {
  double tried = 0, evaluated = 0, accepted = 0;
  MoveCount& operator+=(const MoveCount& o) {
    return tried += o.tried, evaluated += o.evaluated, accepted += o.accepted, *this;
  }
};

/// One Markov chain over a HiddenGraph. It depends on (seed, number), not on threads.
class Chain {
 public:
  Chain(HiddenGraph state, const SamplerParameters& theta, std::uint64_t seed, std::uint32_t number, double evidence = 1);

  /// `proposals` moves for every candidate, in frames six apart at the same time; then all displacements are drawn
  /// anew. Cancelled: between two groups of frames.
  void sweep(double proposals, const core::Context& context);
  /// Its two halves.
  void move(double proposals, const core::Context& context);
  void redraw_displacements();

  [[nodiscard]] const HiddenGraph& state() const { return state_; }
  [[nodiscard]] const SamplerParameters& theta() const { return density_.theta(); }
  void set_theta(const SamplerParameters& theta);
  /// Kept up by the moves' gains; reckoned anew, in O(nodes), where displacements or θ changed since it was asked
  /// for.
  double log_density();
  [[nodiscard]] const std::vector<MoveCount>& counts() const { return counts_; }  ///< by move
  [[nodiscard]] double power() const { return power_; }
  /// Of the state, patches and edges, untempered.
  [[nodiscard]] double evidence() const;
  /// Takes another chain's state and gives it this one's.
  void swap_states(Chain& other);

 private:
  struct FrameTotals {
    double gain = 0;
    std::vector<MoveCount> counts;
  };
  FrameTotals move_in(int frame, double proposals);

  HiddenGraph state_;
  double power_;
  Density density_;
  FactorCache cache_;
  std::uint64_t seed_;
  std::uint32_t number_, sweeps_ = 0;
  std::optional<double> log_density_;
  std::vector<MoveCount> counts_;
};

}  // namespace emberfold::mcmc
