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

/// Finds the places of an event's patches in each of the frames first…last, whether or not they show there:
/// one path of a birth or death, one or two of a joint. Patches are carried by the optical flow. The path of
/// a joint is also stretched between its ends as they move, so that it spans the gap where two strokes are
/// apart: where a frame's graph has a patch of an end, it corrects the place, across the curve alone, since
/// patches of one curve look alike along it. O(frames · patches).
std::vector<std::vector<Path>> follow_event(const graph::TracedEvent& traced, const MotionIndex& motion,
                                            const FrameWindow& window, int first, int last);

}  // namespace emberfold::pipeline
