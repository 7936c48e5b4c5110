// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

/// The graph with its patches on this ground instead of the one they were seen on. A line's sides take the
/// ground's levels there, and its core stays as much brighter or darker than they; a step keeps its contrast
/// and is lifted until its two sides are off by as much. Evened along the strokes. `ground`: CV_32F, 1 or 3
/// channels, white = 255; grey counts for all channels.
graph::AttributeGraph relight(const graph::AttributeGraph& graph, const cv::Mat& background);

}  // namespace emberfold::sketch
