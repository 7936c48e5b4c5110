// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::graph {

/// The frames in the opposite order, vertices numbered anew from 0, in each frame in the order they had.
/// Twice gives the numbering that SketchSequence::append makes.
SketchSequence reversed(const SketchSequence& sketch);

/// The clip run backwards: its frames and links in the opposite sense, vertices numbered and strokes
/// identified anew. An involution on graphs that are so numbered and identified. O(n log n). InputError as
/// validate().
MotionGraph reversed(const MotionGraph& motion);

/// What the events of a clip of so many frames are in the clip run backwards: births for deaths and so on, in
/// frame `frames` − frame; `before` and `after` changed over, their strokes called as they were. Ordered as
/// sort_events orders.
std::vector<Event> reversed(std::vector<Event> events, int frames);

}  // namespace emberfold::graph
