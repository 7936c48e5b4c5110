// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/motion_graph.hpp"

namespace emberfold::graph {

/// Removes flicker from the sketches: changes that last at most `frames` frames between two longer states.
/// A detector that sees a stroke in one frame and misses it in the next makes false events. Repaired are
/// - a stroke that is there in one frame alone: it is removed;
/// - a stroke that vanishes briefly: it is copied from where it last was;
/// - two strokes that are joined briefly: they are cut where they were joined;
/// - a stroke that breaks briefly: the nearest patches of its pieces are joined;
/// - a piece that separates from a stroke and dies, or is born and unites with one: it is removed.
/// Strokes that are born and die within a few frames stay: whether they were there is decided with the other
/// changes (mcmc::sample_changes). `frames` ≤ 0 changes nothing. `motion` has its strokes identified; the
/// result's vertices are renumbered. Time-reversed motion gives the time-reversed result. O((vertices +
/// links) log).
SketchSequence remove_flicker(const MotionGraph& motion, int frames);

}  // namespace emberfold::graph
