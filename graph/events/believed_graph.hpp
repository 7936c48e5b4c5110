// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "graph/events/events.hpp"

namespace emberfold::graph {

/// Edits a matched graph so that it changes where an event is believed, and nowhere else.
/// Strokes get the names of keep_identity(). Edges between two strokes are cut: that they touch is not
/// believed. Pieces of one stroke are joined by an edge, over a gap of at most 30 px; what lies farther from
/// the largest piece is left out. Strokes that begin or end where no event is believed are left out, too,
/// unless one of their ends is believed or they are outlines of more than 100 px: a thing that large is seen,
/// whatever became of it. What comes in or goes out through the picture's border, at a cut (within one frame
/// of `cuts`), or with the clip neither is born nor dies. Links join patches of one stroke, or of strokes
/// that a believed event joins. `believed`: least probability. `events` name strokes of `motion`, which has
/// its strokes identified, and name those of the result afterwards, if they are there. O(n log n) in vertices
/// and links, and the squares of the patches of strokes in pieces.
void keep_believed(MotionGraph& motion, std::vector<Event>& events, std::span<const int> cuts,
                   double believed);

}  // namespace emberfold::graph
