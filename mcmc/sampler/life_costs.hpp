// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "mcmc/sampler/change_field.hpp"

namespace emberfold::mcmc::detail {

/// Costs, in nats, of a birth or death that is not that of a whole stroke, and of a part that begins by a
/// change and ends by none. With costs of 1 to 4 the found and false events of simulated and made scenes
/// hardly differ.
inline constexpr double kLifeCost = 2, kPartCost = 1;

/// Adds up what is inconsistent in a state.
/// The strands between which no change happened make up one life: those of a separation or union that did not
/// happen, and those on both sides of a bridged gap. kLifeCost is the cost of
/// - each birth in a life that began earlier, and each death in one that continues;
/// - a life that is born but ends by no change and does not go out, and of one that dies but has no
/// beginning. kPartCost is the cost of a life that begins by a separation or union and ends by no change, or
/// the reverse. Outlines of things, closed and longer than 100 px, need only one end: they are seen whatever
/// becomes of them. Changes that are not open stay as they are in the first state, so strands between which
/// none can happen are joined once and for all.
class LifeCosts {
 public:
  /// `open`: the changes that may differ between states; `state` is noted. O(strands + changes).
  LifeCosts(const ChangeField& field, const std::vector<bool>& open, const ChangeState& state);

  /// Returns the costs of the lives that hold one of these strands. O(strands of the lives).
  double of(std::span<const std::uint32_t> strands, const ChangeState& state);
  /// Notes the lives of the last call of of(). Its state may differ from the one noted before in changes and
  /// gaps of the strands of that call only, and these must be all that such a change or gap has.
  void note();
  /// Returns what of() returns for the state that was noted last, at once.
  double noted(std::span<const std::uint32_t> strands);
  /// Returns the costs of all lives of the noted state.
  [[nodiscard]] double noted_of_all() const;

 private:
  struct Extent {  // of some strands
    int first = std::numeric_limits<int>::max(), last = -1;
    bool comes_in = false, goes_out = false;  // at `first`, at `last`
    std::size_t patches = 0, closed = 0, frames = 0;
    void add(const Extent& other);
  };
  struct Joint {  // one life with another node while a change does not happen
    std::uint32_t change = 0, node = 0;
  };
  struct Node {  // strands that are one life in every state
    Extent extent;
    std::vector<std::uint32_t> changes, gaps;
    std::vector<Joint> joints;
  };
  struct NodesOfChange {  // a change has one or two strands on a side
    int frame = 0;
    bool is_birth = false, is_death = false;
    std::array<std::uint32_t, 2> before{}, after{};  // the same twice for one strand
  };
  struct Life {
    std::size_t end = 0;  // of its part of found_nodes_
    double cost = 0;
  };
  void join_strands(const std::vector<bool>& can_happen);
  void list_changes(const std::vector<bool>& can_happen);
  double cost_of_life(std::uint32_t node, const ChangeState& state);

  const ChangeField& field_;
  std::vector<std::uint32_t> node_of_;  // each strand
  std::vector<Node> nodes_;
  std::vector<NodesOfChange> changes_;
  std::vector<std::uint32_t> seen_;  // with which life each node was seen last
  std::uint32_t seen_lives_ = 0;
  std::vector<Life> found_;  // lives of the last call of of()
  std::vector<std::uint32_t> found_nodes_;
  std::vector<std::uint32_t> life_of_;  // each node: the node that stands for its life, as noted
  std::vector<double> cost_;            // of the life that a node stands for
};

}  // namespace emberfold::mcmc::detail
