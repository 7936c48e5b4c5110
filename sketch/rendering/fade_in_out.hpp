// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <span>
#include <vector>

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

/// A frame's patches with those that have just gone or are about to come, and how much there is of each.
struct FadedGraph {
  graph::AttributeGraph graph;
  std::vector<float> opacity;  ///< of each patch, 0…1
};

/// Lets patches come and go over six frames, half of them before a patch's first frame and after its last: in
/// none does its opacity change by more than 1/6, and it is there in half when it was before, too. Where a
/// patch is not yet or no more, it is shown as it was in its nearest frame.
class FadeInOut {
 public:
  /// How many frames ahead must be known.
  static constexpr std::size_t kAhead = 4;
  /// The next frame. `ahead`: those that come then, in order; patches keep their ids through time. What is in
  /// the very first frame is there in full.
  FadedGraph next(const graph::AttributeGraph& now, std::span<const graph::AttributeGraph* const> ahead);

 private:
  std::map<std::uint32_t, int> ages_;         // of the patches of the frame before; negative: still to come
  std::deque<graph::AttributeGraph> behind_;  // the newest first
  bool begun_ = false;
};

}  // namespace emberfold::sketch
