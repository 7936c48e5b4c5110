// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/motion_graph.hpp"

namespace emberfold::graph {

/// Links patches that matching left alone because their curve has a patch more or less in the next frame.
/// A patch without a link, beside one with a link, is linked to the nearest patch of the same kind and
/// direction around that link's other end, near where that neighbour's motion takes it: so
/// patches part in two or join in one as a curve grows or shrinks. No two strokes become linked that were
/// not, nothing is linked that would break the star forest, and reversing time gives the same links. O(n log
/// n).
/// The new links are MotionGraph::skipped.
void link_skipped_patches(MotionGraph& motion);

}  // namespace emberfold::graph
