// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/events/events.hpp"
#include "pipeline/inference/motion_index.hpp"

namespace emberfold::pipeline {

/// Renames the strokes of one interpretation's event to those of another.
/// A stroke gets the name of the stroke that coincides with it nearest to the event; one that the other
/// interpretation lacks is left out, and so is a repeated name. O(n log n + n · m) in the patches of the
/// frames.
void name_strokes(graph::Event& event, const MotionIndex& reading, const MotionIndex& named);

}  // namespace emberfold::pipeline
