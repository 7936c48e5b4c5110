// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "mcmc/sampler/hidden_graph.hpp"

// Helpers that count, pick and draw for the moves.
namespace emberfold::mcmc {

/// Returns log n; −∞ for 0.
inline double log_count(std::size_t n) {
  static const auto logs = [] {
    std::array<double, 512> table{};
    for (std::size_t k = 0; k < table.size(); ++k) table[k] = std::log(static_cast<double>(k));
    return table;
  }();
  return n < logs.size() ? logs[n] : std::log(static_cast<double>(n));
}

/// Counts the nodes of a list that `keep` accepts.
template <class Keep>
std::size_t count_if(std::span<const Index> list, Keep keep) {
  std::size_t count = 0;
  for (const Index i : list) count += keep(i);
  return count;
}
/// Returns the n-th node of a list that `keep` accepts, from 0; kNone where there are fewer.
template <class Keep>
Index nth(std::span<const Index> list, std::size_t n, Keep keep) {
  for (const Index i : list)
    if (keep(i) && n-- == 0) return i;
  return kNone;
}

/// Holds the normal distribution that a move draws a displacement from, px.
struct NormalProposal {
  double mean = 0, sd = 1;

  [[nodiscard]] double log_density(double displacement) const {
    constexpr double kHalfLogTwoPi = 0.9189385332046727;
    const double z = (displacement - mean) / sd;
    return -0.5 * z * z - std::log(sd) - kHalfLogTwoPi;
  }
};

}  // namespace emberfold::mcmc
