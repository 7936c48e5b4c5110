// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "graph/events/events.hpp"

namespace emberfold::graph {

/// Lets strokes keep their identity through all that is no believed event.
/// identify() names the components of frames, so every touch and every gap ends a stroke. Here patches keep
/// the identity of the patch that they are linked with, others take that of the nearest one in their
/// component, and components without any are new strokes, and so is what a believed separation or union
/// leaves. So a component may hold patches of several strokes, and a stroke may lie in pieces. Two pieces of
/// one stroke that a believed union joins are two strokes, back to where they came apart. The strokes that
/// events name are renamed with them; what comes later has the higher number. `believed`: least probability.
/// `events` name strokes of `motion`, which has its strokes identified. O(n log n) in vertices and links, and
/// events · patches of their frames.
void keep_identity(MotionGraph& motion, std::vector<Event>& events, double believed);

}  // namespace emberfold::graph
