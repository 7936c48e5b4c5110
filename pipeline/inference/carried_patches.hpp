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

inline constexpr int kFramesCarried = 10;  ///< farthest that a patch is carried

/// Finds the patches of a clip's sketch by place, in the frames that it holds. Refers to the sketch.
class DrawnPatches {
 public:
  explicit DrawnPatches(const graph::SketchSequence& sketch) : sketch_(sketch) {}

  /// Indexes the frames first…end − 1, as far as it does not hold them, and forgets those before. Neither
  /// number may decrease from call to call.
  void hold(int first, int end);

  [[nodiscard]] int frames() const { return static_cast<int>(sketch_.frames.size()); }  ///< of the clip
  [[nodiscard]] const graph::AttributeGraph& graph(int frame) const {
    return sketch_.frames[static_cast<std::size_t>(frame)];
  }
  /// Returns the vertex of a frame that shows the same place of a stroke; of several the nearest.
  [[nodiscard]] std::optional<std::uint32_t> find(int frame, const graph::Patch& patch) const;

 private:
  const graph::SketchSequence& sketch_;
  int first_ = 0;
  std::deque<graph::CoincidenceIndex> places_;
};

/// A patch of one frame, carried to another one that shows it but does not draw it.
struct LastingPatch {
  int source = 0, frame = 0;  ///< where it is from, and where it is now
  std::uint32_t vertex = 0;   ///< of the source's graph
  graph::Patch patch;         ///< as it lies in the frame
  double amplitude = 1;       ///< how strongly it shows, as a share of how it does in the source
};

/// A patch of one frame, carried to another one that draws it.
struct DrawnAgain {
  int source = 0, frame = 0;
  std::uint32_t vertex = 0;  ///< of the source's graph
  std::uint32_t drawn = 0;   ///< of the frame's graph
};

/// Patches that were carried, wherever they are now. Most are drawn, and take a tenth of the memory.
struct CarriedPatches {
  std::vector<LastingPatch> lasting;
  std::vector<DrawnAgain> drawn;
};

/// Carries the patches of a frame along by the window's motion, into the frames after it (`step` 1) or before
/// it (−1), each as far as it is drawn or its profile shows nearly as strongly as there, at most
/// kFramesCarried. Only those are carried that were drawn in the frame on the other side, too. O(patches ·
/// frames carried).
CarriedPatches carry_patches(int source, int step, const DrawnPatches& drawn, const FrameWindow& window);

}  // namespace emberfold::pipeline
