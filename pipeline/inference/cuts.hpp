// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/events/events.hpp"

namespace emberfold::pipeline {

/// Returns the frames, ascending, that show another picture than the frame before: a cut of the film, the
/// first of some black frames and the first after them, a flash. Most of the frame has then another level,
/// and its levels are less than half as like the last frame's (correlation, frames reduced to 64 px) as is
/// usual in the clip; in clips of fires, flags, smoke and water they are always more than .7. Reads the clip
/// once, O(pixels). Throws core::Cancelled.
std::vector<int> find_cuts(core::FrameSource& source, const core::Context& context);

/// Gives the probability 0 to events at cuts, or a frame beside one: what a cut ends or begins is no event.
void disbelieve_cuts(std::vector<graph::Event>& events, const std::vector<int>& cuts);

}  // namespace emberfold::pipeline
