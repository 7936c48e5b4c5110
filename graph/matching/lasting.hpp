// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "graph/motion_graph.hpp"

namespace emberfold::graph::detail {

/// Tells of each vertex of a motion graph whether its component over all frames, by edges and links, lasts
/// longer than `frames`. Of one that is in the clip's first or last frame, and may continue outside the clip,
/// two frames are enough.
class Lasting {
 public:
  Lasting(const MotionGraph& motion, int frames);

  [[nodiscard]] bool operator()(std::size_t frame, std::size_t vertex) const {
    return lasts_[begin_[frame] + vertex];
  }

 private:
  std::vector<std::size_t> begin_;  // of each frame's vertices
  std::vector<bool> lasts_;
};

}  // namespace emberfold::graph::detail
