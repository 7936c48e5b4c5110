// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "core/model_archive.hpp"
#include "graph/motion_graph.hpp"

// The strokes seen in a clip's frames, stored in its model next to them.
namespace emberfold::pipeline {

/// Returns a clip's graphs in the frames `kept`, ascending, with the links across omitted frames composed.
/// Strokes are identified anew.
graph::MotionGraph strokes_of_frames(const graph::MotionGraph& motion, std::span<const int> kept);

/// Adds the arrays "footage_places", "footage_shapes", "footage_levels", "footage_joins", "footage_links" and
/// "footage_counts", 34 bytes a patch; levels are rounded to whole ones, shapes to half precision.
void add_footage_strokes(core::ModelArchive& archive, const graph::MotionGraph& strokes);

/// Reads the strokes; empty where the archive has none. Throws core::IoError, naming the array, where they do
/// not hold graphs of `frames` frames.
graph::MotionGraph read_footage_strokes(const core::ModelArchive& archive, std::size_t frames);

}  // namespace emberfold::pipeline
