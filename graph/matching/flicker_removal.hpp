// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/motion_graph.hpp"

namespace emberfold::graph {

/// Removes flicker from the sketches: changes that last at most `frames` frames between two longer states.
/// A detector that sees a stroke in one frame and misses it in the next makes false events. Repaired are
/// - a stroke that appears briefly: it is removed (at the clip's first and last frame only if it lasts one
///   frame);
/// - a stroke that vanishes briefly: it is copied from where it last was;
/// - two strokes that are joined briefly: they are cut where they were joined;
/// - a stroke that breaks briefly: the nearest patches of its pieces are joined;
/// - a piece that separates from a stroke and dies, or is born and unites with one: it is removed.
/// Strokes whose patches gain less than the median have to last up to twice as long. `frames` ≤ 0 changes
/// nothing. `motion` has its strokes identified; the result's vertices are renumbered. Time-reversed motion
/// gives the time-reversed result. O((vertices + links) log).
SketchSequence remove_flicker(const MotionGraph& motion, int frames);

}  // namespace emberfold::graph
