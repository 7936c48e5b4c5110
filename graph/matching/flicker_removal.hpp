// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/motion_graph.hpp"

namespace emberfold::graph {

/// The sketches without what flickers: a detector that sees a stroke in one frame and misses it in the next
/// makes events that nobody else sees. For at most `frames` frames, between two longer states that agree,
/// - something is there: it is left out (at the clip's first and last frame only if it is there for one
/// frame);
/// - a stroke is missing: it is put in, where it last was;
/// - two strokes are joined that are apart before and after: they are cut where they were joined;
/// - a stroke is in two pieces that are joined before and after: the nearest patches of the pieces are
/// joined;
/// - a piece parts from a stroke and dies: it is left out.
/// Strokes whose patches gain less than usual have to last longer, up to twice. The same backwards in time.
/// The motion graph has its strokes identified; vertices are numbered anew. O((vertices + links) log).
SketchSequence steady(const MotionGraph& motion, int frames);

}  // namespace emberfold::graph
