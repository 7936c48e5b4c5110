// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/command.hpp"
#include "apps/ground.hpp"
#include "core/clip.hpp"
#include "graph/motion_graph.hpp"
#include "sketch/extract.hpp"

namespace emberfold::apps {

/// Every frame's graph, and the ground between its strokes.
struct SketchedClip {
  graph::SketchSequence sketch;
  std::vector<FrameGround> grounds;
};

/// Reads the clip from its first frame, some frames on several threads at once. Throws Interrupted.
SketchedClip sketch_clip(core::FrameSource& source, const sketch::ExtractOptions& options,
                         const Session& session);

}  // namespace emberfold::apps
