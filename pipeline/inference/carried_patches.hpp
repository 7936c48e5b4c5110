// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "graph/matching/coincidence.hpp"
#include "graph/motion_graph.hpp"
#include "pipeline/inference/frame_window.hpp"

namespace emberfold::pipeline {

inline constexpr int kFramesCarried = 10;  ///< maximum distance in time over which a patch is propagated

/// Finds the patches of a clip's sketch by place, in the frames that it holds. Keeps a reference to the
/// sketch.
class DrawnPatches {
 public:
  explicit DrawnPatches(const graph::SketchSequence& sketch) : sketch_(sketch) {}

  /// Indexes the frames first…end − 1, if not yet indexed, and drops those before. Neither number may
  /// decrease from call to call.
  void hold(int first, int end);

  [[nodiscard]] int frames() const { return static_cast<int>(sketch_.frames.size()); }  ///< of the clip
  [[nodiscard]] const graph::AttributeGraph& graph(int frame) const {
    return sketch_.frames[static_cast<std::size_t>(frame)];
  }
  /// Returns the vertex of a frame that shows the same place of a stroke; of several, the nearest.
  [[nodiscard]] std::optional<std::uint32_t> find(int frame, const graph::Patch& patch) const;

 private:
  const graph::SketchSequence& sketch_;
  int first_ = 0;
  std::deque<graph::CoincidenceIndex> places_;
};

/// A patch of one frame, propagated to another one that shows it but does not draw it.
struct LastingPatch {
  int source = 0, frame = 0;  ///< the patch's own frame, and the frame that it has reached
  std::uint32_t vertex = 0;   ///< of the source's graph
  graph::Patch patch;         ///< at its place in `frame`
  double amplitude = 1;       ///< of the patch in `frame`, relative to that in the source
};

/// A patch of one frame, propagated to another one that draws it.
struct DrawnAgain {
  int source = 0, frame = 0;
  std::uint32_t vertex = 0;  ///< of the source's graph
  std::uint32_t drawn = 0;   ///< of the frame's graph
};

/// Propagated patches, in all frames that they reached. Most are drawn, and take a tenth of the memory.
struct CarriedPatches {
  std::vector<LastingPatch> lasting;
  std::vector<DrawnAgain> drawn;
};

/// Propagates the patches of a frame by the window's motion, into later (`step` 1) or earlier frames (−1).
/// Each is propagated while it is drawn or its profile is nearly as strong as in its source frame, at most
/// over kFramesCarried. Only patches that were also drawn in the frame on the other side are propagated.
/// O(patches · frames reached).
CarriedPatches carry_patches(int source, int step, const DrawnPatches& drawn, const FrameWindow& window);

}  // namespace emberfold::pipeline
