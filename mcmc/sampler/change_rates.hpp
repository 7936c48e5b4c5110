// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mcmc/sampler/change_field.hpp"

namespace emberfold::mcmc::detail {

inline constexpr double kRateReach = 400;   ///< px: changes farther away say nothing about each other
inline constexpr double kUsualShare = 0.4;  ///< of true changes, where the log odds of the images hold

/// Learns what share of the changes read from the graphs is true, by place: the rates of a clip's operators,
/// over how often the graphs read one.
/// The share at a place is the mean of the changes' probabilities, weighted by (1 − d²/kRateReach²)² at the
/// distance d; half of a true and of a false change are counted beforehand. It is one for each square of 32
/// px. Births and deaths of strokes that last at most three frames have a share of their own.
class ChangeRates {
 public:
  explicit ChangeRates(const ChangeField& field);

  /// Takes the mean number of times that each change happened. O(squares²).
  void learn(std::span<const double> happened);
  /// Repeats learn() with the probabilities of changes that know nothing of each other, until the shares
  /// stand still: the fixed point of Saerens, Latinne & Decaestecker (2002).
  void learn_alone();
  /// Returns the log odds of each change at the share about it.
  [[nodiscard]] const std::vector<double>& log_odds() const { return log_odds_; }

 private:
  struct Square {
    bool brief;   // its changes are of strokes that last a short time
    double x, y;  // px, of its middle
    std::vector<std::uint32_t> changes;
  };
  const ChangeField& field_;
  std::vector<Square> squares_;
  std::vector<double> log_odds_;
};

}  // namespace emberfold::mcmc::detail
