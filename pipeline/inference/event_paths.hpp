// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "graph/events/events.hpp"
#include "graph/patch.hpp"
#include "pipeline/inference/frame_window.hpp"
#include "pipeline/inference/motion_index.hpp"

namespace emberfold::pipeline {

/// Patches along a curve, from one end to the other.
using Path = std::vector<graph::Patch>;

/// Finds the places of an event's patches in each of the frames first…last, whether or not they show there.
/// Returns a few guesses for each frame. Patches are propagated by the optical flow; where a frame's graph
/// has such patches they correct the place, across the curve alone, since patches of one curve look alike
/// along it. The path that joins two strokes is kept between their ends as they move, so that it spans the
/// gap where they are apart. O(frames · patches).
std::vector<std::vector<Path>> follow_event(const graph::TracedEvent& traced, const MotionIndex& motion,
                                            const FrameWindow& window, int first, int last);

}  // namespace emberfold::pipeline
