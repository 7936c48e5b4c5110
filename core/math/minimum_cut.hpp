// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace emberfold::core {

/// A graph whose nodes are divided into a first and a second side at the least cost of the edges cut: the
/// augmenting paths of Boykov & Kolmogorov (2004), by Boost.Graph. The cut is exact for whole numbers whose
/// sum is below 2⁵³.
class MinimumCut {
 public:
  explicit MinimumCut(std::size_t nodes) : room_(nodes, 0) {}

  /// Adds the costs of a node on the first and on the second side, ≥ 0.
  void add_costs(std::size_t node, double on_first, double on_second);
  /// Adds the costs of a pair that is cut, ≥ 0: `a` on the first side and `b` on the second, and the reverse.
  void add_edge(std::size_t a, std::size_t b, double cost, double reverse_cost);

  /// Finds the cut and returns its cost. To be called once.
  double solve();
  /// Returns whether a node is on the second side; of several least cuts that with the smallest first side.
  [[nodiscard]] bool is_second(std::size_t node) const { return second_[node]; }

 private:
  struct Arc {
    std::size_t from, to;
    double capacity;
  };

  std::vector<double> room_;  // of nodes, from the first terminal; below 0: to the second
  std::vector<Arc> arcs_;     // in pairs, there and back
  std::vector<bool> second_;
  double common_ = 0;  // cost of nodes on either side
};

}  // namespace emberfold::core
