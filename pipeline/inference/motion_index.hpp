// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "graph/matching/coincidence.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::pipeline {

/// Finds the patches of a motion graph by link and by place, in the frames that it holds. Keeps a reference
/// to the graph.
class MotionIndex {
 public:
  explicit MotionIndex(const graph::MotionGraph& motion) : motion_(motion) {}

  /// Indexes the frames first…end − 1, if not yet indexed, and drops those before. Neither number may
  /// decrease from call to call.
  void hold(int first, int end);

  [[nodiscard]] const graph::AttributeGraph& graph(int frame) const {
    return motion_.sketch.frames[static_cast<std::size_t>(frame)];
  }
  /// Returns the vertex linked with a vertex in the next or (`step` −1) the previous frame; of several, the
  /// first.
  [[nodiscard]] std::optional<std::uint32_t> linked(int frame, std::uint32_t vertex, int step) const;
  /// Returns the vertex of a frame that shows the same place of a stroke; of several, the nearest.
  [[nodiscard]] std::optional<std::uint32_t> coinciding(int frame, const graph::Patch& patch) const {
    return held(frame).places.find(patch);
  }

 private:
  struct Frame {
    std::vector<std::uint32_t> next, previous;  // vertex indices; kNone without a link
    graph::CoincidenceIndex places;
  };
  [[nodiscard]] Frame index(std::size_t frame) const;
  [[nodiscard]] const Frame& held(int frame) const {
    return frames_[static_cast<std::size_t>(frame - first_)];
  }

  const graph::MotionGraph& motion_;
  int first_ = 0;
  std::deque<Frame> frames_;
};

}  // namespace emberfold::pipeline
