// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/motion_graph.hpp"
#include "sketch/background/background.hpp"
#include "sketch/extract.hpp"

namespace emberfold::pipeline {

/// Default options of a sketch whose strokes are followed in time: strokes that flicker would count as
/// events.
inline constexpr sketch::ExtractOptions kFollowedSketch = {.sensitivity = 0.35};

/// Options of a sketch that is looked at, not followed in time, unless others are asked for.
inline constexpr sketch::ExtractOptions kPictureSketch = {.outlines = true};

/// Holds every frame's graph and the background between its strokes.
struct SketchedClip {
  graph::SketchSequence sketch;
  std::vector<sketch::FrameBackground> grounds;
};

/// Receives the frames sketched so far, from `first` on.
using KeepSketch = std::function<void(const SketchedClip& clip, std::size_t first)>;

/// Sketches a clip from its first frame, some frames on several threads at once.
/// `begun`: frames stored by an earlier call; the result is the same with them. `keep` is called after every
/// few frames, and always after the last, with those that it has not yet received. Throws core::Cancelled.
SketchedClip sketch_clip(core::FrameSource& source, const sketch::ExtractOptions& options,
                         const core::Context& context, SketchedClip begun = {}, const KeepSketch& keep = {});

}  // namespace emberfold::pipeline
