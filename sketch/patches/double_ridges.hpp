// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "graph/attribute_graph.hpp"
#include "sketch/refinement/coding_length.hpp"

namespace emberfold::sketch {

/// Two lines of one sign that run side by side become one double ridge as far as that shortens the frame's
/// code: for at least three patches, their middles at most 16 px apart. What lies between them goes with
/// them. Where the lines go on by themselves, the double ridge forks; what is left of a line's end, two
/// patches at most, may go. A pair is judged as it would be drawn (drawn_change); the pairs that save most
/// come first. `graph`: of `levels` (CV_32F, 1 or 3 channels), its patches judged; `luma`: their luma,
/// prepared; `spacing`: px from patch to patch. O(patches · log) beside some milliseconds for each pair.
graph::AttributeGraph merge_double_ridges(const graph::AttributeGraph& graph, const cv::Mat& levels,
                                          const CodingContext& luma, double spacing);

}  // namespace emberfold::sketch
