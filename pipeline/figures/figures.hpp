// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::pipeline {

/// Figures of a clip: things wider than a line that are brighter or darker than their ground, such as
/// droplets, flames and folds.
struct Figures {
  graph::MotionGraph motion;         ///< their outlines; strokes identified
  std::vector<graph::Event> events;  ///< all changes of these strokes, each with its probability
};

/// Finds the figures of a clip, follows them in time, and reads off where they are born, die, split and
/// merge. Frames are labelled by the amplitude of figures, −1 at the level of the ground to 1 at that of the
/// figure, at three thresholds and for both polarities; regions are linked by motion. The probability of a
/// change is the share of the thresholds that see it, where it can be followed (weigh_figure_changes). What
/// `lines`, the clip's sketch, draw well are lines and no figures (find_families). Reads
/// the clip three times. The same bytes at any number of threads. Holds no figures for frames of less than 32
/// px. Throws core::Cancelled. O(pixels). See docs/method/figures.md.
Figures find_figures(core::FrameSource& source, const graph::SketchSequence& lines,
                     const core::Context& context = {});

/// Returns the sketches without the lines that figures show: those whose flanks lie on an outline, and whole
/// strokes that do so with a figure that ends up to two frames before or begins as much after: it fades.
graph::SketchSequence without_outlines(const graph::SketchSequence& lines,
                                       const graph::SketchSequence& outlines);

/// Adds figures to the motion graph of a clip's lines, and their events after its events. The strokes of both
/// are identified anew, and the events name them so.
void add_figures(graph::MotionGraph& lines, std::vector<graph::Event>& events, Figures figures);

}  // namespace emberfold::pipeline
