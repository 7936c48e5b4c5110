// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::graph {

/// Reverses the order of the frames.
/// Vertices are renumbered from 0 and keep their order within a frame, as SketchSequence::append does.
SketchSequence reverse_time(const SketchSequence& sketch);

/// Reverses the time of a motion graph: its frames and links run backwards.
/// Vertices are renumbered and strokes identified again; on such graphs it is an involution. Throws
/// InputError as validate() does. O(n log n).
MotionGraph reverse_time(const MotionGraph& motion);

/// Returns what a class of events is in reversed time: of a birth a death, of a split a merge, and so on.
EventType reverse_time(EventType type);

/// Reverses the time of events of a clip of `frames` frames.
/// Births become deaths and so on, in frame `frames` − frame; `before` and `after` are swapped, their strokes
/// keep their identities. Sorted as by sort_events.
std::vector<Event> reverse_time(std::vector<Event> events, int frames);

}  // namespace emberfold::graph
