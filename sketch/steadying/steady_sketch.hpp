// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "sketch/extract.hpp"
#include "sketch/steadying/carried_sketch.hpp"

namespace emberfold::sketch {

/// Returns the sketch of a frame on which its neighbours in time agree: a median over time of what is drawn.
/// Where a neighbour's image, carried by the motion, looks like this frame's, its sketch has a vote on every
/// stroke there; where the image differs, as it does where a stroke is born or breaks, it has none. Runs of
/// patches that the votes speak against go; runs that most neighbours have and this frame lacks are offered
/// to refine(), which fits them to this frame. Without neighbours the sketch stays as it is. `own`: extracted
/// from `levels` with `options`. O(patches · neighbours).
graph::AttributeGraph steady_sketch(const cv::Mat& levels, const graph::AttributeGraph& own,
                                    std::span<const CarriedSketch> neighbours, const ExtractOptions& options);

}  // namespace emberfold::sketch
