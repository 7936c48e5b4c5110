// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::graph {

/// Returns the graph without edges between different strokes.
AttributeGraph without_touches(const AttributeGraph& graph);

/// Returns a motion graph whose strokes are the curves of `motion`: without the edges between different
/// curves, nor the links of too few patches between what is left (supported_links); a vertex's stroke is its
/// curve. A curve of several pieces is several components of one stroke. The curves must be identified.
/// Throws InputError as validate() does. O(n log n).
MotionGraph curves_as_strokes(const MotionGraph& motion);

/// Tells whether an event of curves leaves the components of the graph as they are, so that a name changes
/// and nothing else: the birth or death of a branch (it touches another curve with an end of its own: what
/// grows out of a curve, or comes out beyond one that it crosses, is not born), the union of curves that
/// touched in the frame before, the separation of curves that still touch. `motion`: with the curves
/// identified that `event` names as strokes. O(n) of one frame.
bool changes_names_alone(const MotionGraph& motion, const Event& event);

}  // namespace emberfold::graph
