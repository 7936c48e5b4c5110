// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

/// Returns the graph with its patches' levels moved to those of another background. A line's sides take the
/// background's levels there, and its core stays as much brighter or darker than they. A step keeps its
/// contrast and is lifted until both sides are off by as much. The changes are evened along the strokes.
/// `background`: CV_32F, 1 or 3 channels, white = 255; a grey one counts for all channels. O(pixels +
/// patches).
graph::AttributeGraph relight(const graph::AttributeGraph& graph, const cv::Mat& background);

}  // namespace emberfold::sketch
