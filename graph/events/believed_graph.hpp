// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "graph/events/events.hpp"

namespace emberfold::graph {

/// Edits a matched graph so that it changes where an event is believed, and nowhere else.
/// Strokes get the names of keep_identity(). Edges between two strokes are cut: that they touch is not
/// believed. Pieces of one stroke are joined by an edge, over a gap of at most 30 px, those of outlines of
/// more than 100 px over any gap; what lies farther from the largest piece is left out. Strokes of which one
/// end alone is believed get the other one, too, or lose both, as the odds of both ends say
/// (settle_open_ends); then strokes begin anew. Strokes without a believed end are left out, but for outlines
/// of more than 100 px: a thing that large is seen, whatever became of it. What comes in or goes out through
/// the picture's border, at a cut (within one frame of `cuts`), or with the clip neither is born nor dies.
/// Links join patches of one stroke, or of strokes that a believed event joins. `believed`: least
/// probability. `events` name strokes of `motion`, which has its strokes identified; they get the
/// probabilities that were decided, and name the strokes of the result, if they are there. O(n log n) in
/// vertices and links, and the squares of the patches of strokes in pieces.
void keep_believed(MotionGraph& motion, std::vector<Event>& events, std::span<const int> cuts,
                   double believed);

}  // namespace emberfold::graph
