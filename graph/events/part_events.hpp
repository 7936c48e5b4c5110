// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "graph/events/events.hpp"

namespace emberfold::graph {

/// Finds the events that a viewer may see in the graphs: those of trace_stroke_events, and the births and
/// deaths of long parts of strokes.
/// A line that appears all at once beside others and touches them makes no new component: it is an end of
/// theirs that is longer now. Its patches have no links, in a path of 20 px or more of a stroke that goes on.
/// It is a birth, or a death if it vanishes, unless half of it joins two strokes (or parts them). Parts of
/// strokes that are born (die) within 4 frames belong to their birth (death). These events do not add up to
/// changes of tips and components. Sorted as by sort_events. Throws InputError as validate() does.
/// O(n log n) in vertices and links.
std::vector<TracedEvent> trace_seen_events(const MotionGraph& motion);

}  // namespace emberfold::graph
