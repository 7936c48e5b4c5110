// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

/// Minimum cuts. Inner header of quilting.
namespace emberfold::dytex::detail {

/// A graph whose nodes are divided into a first and a second side at the least cost of the edges cut: the
/// augmenting paths of Boykov & Kolmogorov (2004), whose two search trees are kept from path to path. Costs
/// are whole numbers, so that the cut is exact; the sum of all has to stay below 2³¹ at any node.
class MinCut {
 public:
  explicit MinCut(std::size_t nodes, std::size_t edges = 0);

  /// Adds the costs of a node on the first and on the second side, ≥ 0.
  void add_costs(std::int32_t node, std::int32_t on_first, std::int32_t on_second);
  /// Adds the costs of a pair that is cut, ≥ 0: `a` on the first side and `b` on the second, and the reverse.
  void add_edge(std::int32_t a, std::int32_t b, std::int32_t cost, std::int32_t reverse_cost);

  /// Finds the cut and returns its cost. To be called once.
  std::int64_t solve();
  /// Returns whether a node is on the second side; of several least cuts that with the smallest first side.
  [[nodiscard]] bool is_second(std::int32_t node) const;

 private:
  struct Arc {
    std::int32_t head, next, room;  // the reverse arc has the index ^ 1
  };
  struct Node {
    std::int32_t first = -1, parent = -1;  // arcs; a parent may be one of the marks in the source
    std::int32_t time = 0, distance = 0;
    std::int32_t room = 0;  // > 0: from the first terminal, < 0: to the second
    bool in_second = false, waits = false;
  };

  Node& node(std::int32_t i) { return nodes_[static_cast<std::size_t>(i)]; }
  Arc& arc(std::int32_t a) { return arcs_[static_cast<std::size_t>(a)]; }
  // Returns the capacity that remains on an arc of `side`'s tree, away from the first terminal.
  std::int32_t& room_up(std::int32_t a, bool second) { return arc(second ? a : a ^ 1).room; }
  void wake(std::int32_t i);
  std::int32_t next_awake();
  std::int32_t grow(std::int32_t i);
  void augment(std::int32_t bridge);
  std::int32_t narrowest(std::int32_t i, bool second, std::int32_t least);
  void push(std::int32_t i, bool second, std::int32_t amount);
  void orphan(std::int32_t i, bool at_front);
  void adopt(std::int32_t i);
  std::int32_t distance_to_root(std::int32_t i);

  std::vector<Node> nodes_;
  std::vector<Arc> arcs_;
  std::deque<std::int32_t> awake_, orphans_;
  std::int32_t time_ = 0;
  std::int64_t flow_ = 0;
};

}  // namespace emberfold::dytex::detail
