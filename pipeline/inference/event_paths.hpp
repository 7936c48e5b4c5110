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

/// Finds where the patches of an event are in each of the frames first…last, whether or not they show there.
/// Returns a few guesses for each frame. What moves smoothly is carried along by the optical flow; what has
/// patches in a frame's graph is corrected by them, across the curve alone, since patches of one curve look
/// alike along it. The path that joins two strokes is kept between their ends as they move, so that it spans
/// the gap where they are apart; where they are joined in other frames, too, the paths there are taken as
/// well. O(frames² · patches).
std::vector<std::vector<Path>> follow_event(const graph::TracedEvent& traced, const MotionIndex& motion,
                                            const FrameWindow& window, int first, int last);

}  // namespace emberfold::pipeline
