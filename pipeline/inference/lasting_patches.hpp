// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::pipeline {

/// Adds to each frame's sketch the patches that it lacks although the frame shows them.
/// Patches drawn in frames up to 10 before and after it are propagated by optical flow for as long as their
/// profile is nearly as strong there. Strokes near a threshold thus appear and disappear less often; where a
/// stroke ends or breaks, nothing is added. Both senses of time are treated alike. `source`: the clip of the
/// sketch, which is read once. Holds about 20 frames. Throws core::InputError where their frames differ in
/// number, and core::Cancelled. O(patches · frames reached).
graph::SketchSequence add_lasting_patches(core::FrameSource& source, const graph::SketchSequence& sketch,
                                          const core::Context& context = {});

}  // namespace emberfold::pipeline
