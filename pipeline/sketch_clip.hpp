// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/motion_graph.hpp"
#include "sketch/background/still_background.hpp"
#include "sketch/extract.hpp"

namespace emberfold::pipeline {

/// Sensitivity of a sketch whose strokes are followed in time, unless another is asked for: what comes and
/// goes from frame to frame would count as events.
inline constexpr double kSteadySensitivity = 0.3;

/// Holds every frame's graph and the background between its strokes.
struct SketchedClip {
  graph::SketchSequence sketch;
  std::vector<sketch::FrameBackground> grounds;
};

/// Sketches a clip from its first frame, some frames on several threads at once. Throws core::Cancelled.
SketchedClip sketch_clip(core::FrameSource& source, const sketch::ExtractOptions& options,
                         const core::Context& context);

}  // namespace emberfold::pipeline
