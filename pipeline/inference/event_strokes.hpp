// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/events/events.hpp"
#include "pipeline/inference/motion_index.hpp"

namespace emberfold::pipeline {

/// Gives an event of one reading the strokes of another reading.
/// A stroke takes the name of the stroke that shows its place nearest to the event; one that the other
/// reading lacks is left out, and so is a name that is there already. O(n log n + n · m) in the patches of
/// the frames.
void name_strokes(graph::Event& event, const MotionIndex& reading, const MotionIndex& named);

}  // namespace emberfold::pipeline
