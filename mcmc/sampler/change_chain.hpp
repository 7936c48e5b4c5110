// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/rng.hpp"
#include "mcmc/sampler/change_moves.hpp"
#include "mcmc/sampler/life_costs.hpp"

namespace emberfold::mcmc::detail {

/// Returns the logarithm of a state's probability, but for a constant: the log odds of what happened less the
/// costs of lives. −∞ where a gap is bridged of which the death or birth happened, or of which another gap
/// is.
double log_density(const ChangeField& field, std::span<const double> log_odds, const ChangeState& state);

/// A Markov chain over the states of a field.
class ChangeChain {
 public:
  ChangeChain(const ChangeField& field, ChangeState state);

  /// Chooses which changes are open, before the first sweep at the latest: others do not happen.
  void open(const std::vector<bool>& changes);
  /// Proposes each move of the open changes once, in order; Metropolis, Rosenbluth, Rosenbluth, Teller &
  /// Teller 1953.
  void sweep(std::span<const ChangeMove> moves, std::span<const double> log_odds, core::Rng& rng);

  [[nodiscard]] const ChangeState& state() const { return state_; }
  /// Returns log_density() of its state.
  [[nodiscard]] double log_density(std::span<const double> log_odds) const;
  /// Moves proposed, and accepted, by kind.
  [[nodiscard]] const std::array<double, kMoveNames.size()>& tried() const { return tried_; }
  [[nodiscard]] const std::array<double, kMoveNames.size()>& accepted() const { return accepted_; }

 private:
  void turn(const ChangeMove& move);
  [[nodiscard]] bool is_allowed(const ChangeMove& move) const;

  const ChangeField& field_;
  ChangeState state_;
  std::vector<std::vector<std::uint32_t>> gaps_of_;  // of each change
  std::optional<LifeCosts> costs_;
  std::array<double, kMoveNames.size()> tried_{}, accepted_{};
};

}  // namespace emberfold::mcmc::detail
