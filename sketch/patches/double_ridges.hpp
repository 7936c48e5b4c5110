// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "graph/attribute_graph.hpp"
#include "sketch/refinement/coding_length.hpp"

namespace emberfold::sketch {

/// Merges two parallel lines of one sign into a double ridge where that shortens the code.
/// The ridge has at least three patches, and the lines' middles are at most 16 px apart. Patches between them
/// are removed. Where the lines go on by themselves, the double ridge forks; a short rest of a line's end,
/// two patches at most, may be removed. A pair is judged as it would be drawn (drawing_cost_change); the
/// pairs that save most come first. `graph`: of `levels` (CV_32F, 1 or 3 channels), its patches with their
/// gain; `luma`: their luma, prepared; `spacing`: px from patch to patch. O(patches · log) beside some
/// milliseconds for each pair.
graph::AttributeGraph merge_double_ridges(const graph::AttributeGraph& graph, const cv::Mat& levels,
                                          const CodingContext& luma, double spacing);

}  // namespace emberfold::sketch
