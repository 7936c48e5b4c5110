// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/motion_graph.hpp"

namespace emberfold::graph {

/// Returns the graph without edges between different strokes.
AttributeGraph without_touches(const AttributeGraph& graph);

/// Returns a motion graph whose strokes are the curves of `motion`: without the edges between different
/// curves, nor the links of too few patches between what is left (supported_links); a vertex's stroke is its
/// curve. A curve of several pieces is several components of one stroke. The curves must be identified.
/// Throws InputError as validate() does. O(n log n).
MotionGraph curves_as_strokes(const MotionGraph& motion);

}  // namespace emberfold::graph
