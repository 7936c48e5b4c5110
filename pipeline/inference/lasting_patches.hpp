// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::pipeline {

/// Adds to the sketch of each frame what it lacks though the frame shows it: patches that are drawn in frames
/// up to 10 before and after it, carried along by optical flow for as long as their profile shows nearly as
/// strongly there. What is drawn by chance near a threshold so comes and goes less often; where a
/// stroke ends or breaks, nothing is added. Both senses of time are alike. `source`: the clip of the sketch,
/// which is read once. Holds some 20 frames. Throws core::InputError where their frames differ in number, and
/// core::Cancelled. O(patches · frames carried).
graph::SketchSequence add_lasting_patches(core::FrameSource& source, const graph::SketchSequence& sketch,
                                          const core::Context& context = {});

}  // namespace emberfold::pipeline
