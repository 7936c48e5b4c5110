// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "core/model_archive.hpp"
#include "graph/motion_graph.hpp"

// The strokes that were seen in a clip's own frames, as a part of its model beside them.
namespace emberfold::pipeline {

/// Returns a clip's graphs in the frames `kept`, ascending, with links over the frames that are left out
/// followed through. Strokes are identified anew.
graph::MotionGraph strokes_of_frames(const graph::MotionGraph& motion, std::span<const int> kept);

/// Adds the arrays "footage_places", "footage_shapes", "footage_levels", "footage_joins", "footage_links" and
/// "footage_counts", 34 bytes a patch; levels are rounded to whole ones, shapes to half precision.
void add_footage_strokes(core::ModelArchive& archive, const graph::MotionGraph& strokes);

/// Reads them; empty where the archive has none. Throws core::IoError, naming the array, where they are no
/// graphs of `frames` frames.
graph::MotionGraph read_footage_strokes(const core::ModelArchive& archive, std::size_t frames);

}  // namespace emberfold::pipeline
