// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "core/rng.hpp"

namespace emberfold::mcmc {

/// Supplies the draws of the moves: random numbers, or every outcome in turn (mcmc/sampler/ratio_check.hpp).
class ChoiceSource {
 public:
  virtual ~ChoiceSource() = default;
  /// Draws uniformly from {0, …, count − 1}; count ≥ 1.
  virtual std::size_t below(std::size_t count) = 0;
  /// Draws i with probability weights[i]; the weights sum to 1. An index of weight 0 is never drawn.
  virtual std::size_t pick(std::span<const double> weights) = 0;
  virtual double normal(double mean, double sd) = 0;

  bool coin() { return below(2) == 1; }
};

class RandomChoices final : public ChoiceSource {
 public:
  explicit RandomChoices(const core::Rng& rng) : rng_(rng) {}
  std::size_t below(std::size_t count) override { return rng_.below(static_cast<std::uint32_t>(count)); }
  std::size_t pick(std::span<const double> weights) override {
    double left = rng_.uniform();
    std::size_t i = 0;
    for (; i + 1 < weights.size() && left >= weights[i]; ++i) left -= weights[i];
    while (i > 0 && weights[i] <= 0) --i;  // rounding may leave an index of weight 0
    return i;
  }
  double normal(double mean, double sd) override { return mean + sd * rng_.normal(); }
  double uniform() { return rng_.uniform(); }

 private:
  core::Rng rng_;
};

}  // namespace emberfold::mcmc
