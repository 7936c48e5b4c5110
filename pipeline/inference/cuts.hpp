// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/events/events.hpp"

namespace emberfold::pipeline {

/// Returns the frames, ascending, at which the picture changes: a cut of the film, black frames and the first
/// frame after them, a flash. There half of the pixels change by 6 grey levels or more, and the correlation
/// with the frame before, both reduced to 64 px across, is less than half of the clip's median. Reads the
/// clip once, O(pixels). Throws core::Cancelled.
std::vector<int> find_cuts(core::FrameSource& source, const core::Context& context);

/// Sets the probability of events within one frame of a cut to 0: strokes that a cut ends or begins are no
/// events.
void disbelieve_cuts(std::vector<graph::Event>& events, const std::vector<int>& cuts);

}  // namespace emberfold::pipeline
