// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "mcmc/sampler/change_field.hpp"

namespace emberfold::mcmc::detail {

/// Nats that a birth or death costs that is none of a whole stroke, and an end of a part that has no other
/// one. Between 1 and 4 nats found and false events of simulated and made scenes hardly differ.
inline constexpr double kLifeCost = 2, kPartCost = 1;

/// Counts how far a state's births and deaths are those of whole strokes.
/// The life of a stroke are the strands between which no change happened: those of a separation or union that
/// did not happen, and those of a gap that it goes on through. These cost kLifeCost:
/// - a birth in a life that began before, and a death in one that goes on;
/// - the birth of a life that ends by no change and does not go out, and the death of one that begins so;
/// and kPartCost a life that begins by a separation or union and does not end by any change, or the reverse.
/// The latter two do not hold for outlines of things, closed and longer than 100 px, which are seen whatever
/// becomes of them.
/// Changes that are not open are taken as they are in the first state: strands between which none can happen
/// are one from the start.
class LifeCosts {
 public:
  /// `open`: the changes that may differ between states; `state` is noted. O(strands + changes).
  LifeCosts(const ChangeField& field, const std::vector<bool>& open, const ChangeState& state);

  /// Returns the costs of the lives that hold one of these strands. O(strands of the lives).
  double of(std::span<const std::uint32_t> strands, const ChangeState& state);
  /// Returns the same of the state that was noted last, at once.
  double noted(std::span<const std::uint32_t> strands);
  /// Notes a state that differs from the one noted before in changes and gaps of these strands, all of them.
  void note(std::span<const std::uint32_t> strands, const ChangeState& state);
  /// Returns the costs of all lives of the noted state.
  [[nodiscard]] double noted_of_all() const;

 private:
  struct Extent {  // of some strands
    int first = std::numeric_limits<int>::max(), last = -1;
    bool comes_in = false, goes_out = false;  // at `first`, at `last`
    double patches = 0, closed = 0, frames = 0;
    void add(const Extent& other);
  };
  struct Node {  // strands that are one life in every state
    Extent extent;
    std::vector<std::uint32_t> changes, gaps;
  };
  void join_strands(const std::vector<bool>& can_happen);
  double cost_of_life(std::uint32_t node, const ChangeState& state);
  void visit(std::span<const std::uint32_t> strands);

  const ChangeField& field_;
  std::vector<std::uint32_t> node_of_;  // each strand
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> seen_;  // in which call each node was seen last
  std::uint32_t call_ = 0;
  std::vector<std::uint32_t> life_;     // nodes
  std::vector<std::uint32_t> life_of_;  // each node: the node that stands for its life, as noted
  std::vector<double> cost_;            // of the life that a node stands for
};

}  // namespace emberfold::mcmc::detail
