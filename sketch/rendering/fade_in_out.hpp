// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <span>
#include <vector>

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

/// Holds a frame's patches, those that have just gone or are about to come included, with their opacities.
struct FadedGraph {
  graph::AttributeGraph graph;
  std::vector<float> opacity;  ///< of each patch, by index, 0…1
};

/// Fades patches in and out over six frames. Half of them lie before a patch's first frame, half after its
/// last. No opacity changes by more than 1/6 a frame. Outside its lifetime a patch is shown as it was in its
/// nearest frame. Anchors are there in their own frame alone, and opaque.
class FadeInOut {
 public:
  /// Number of frames ahead that next() needs.
  static constexpr std::size_t kAhead = 4;
  /// Returns the next frame. `ahead`: the frames after it, in order; patches keep their ids through time. All
  /// patches of the very first frame are opaque.
  FadedGraph next(const graph::AttributeGraph& now, std::span<const graph::AttributeGraph* const> ahead);

 private:
  std::map<std::uint32_t, int> ages_;         // of the patches of the frame before; negative: still to come
  std::deque<graph::AttributeGraph> behind_;  // the newest first
  bool begun_ = false;
};

}  // namespace emberfold::sketch
