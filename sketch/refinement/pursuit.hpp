// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

/// Holds the settings of pursue().
struct PursuitOptions {
  double noise = 1;   ///< grey levels, > 0: SD of the pixel noise
  double budget = 1;  ///< (0, 1]: share of the frame's pixels that patches may show
};

/// Runs phase I of the sketch pursuit (Guo, Zhu & Wu 2007), with the fill for places without patches. From
/// nothing, round by round, it draws the patches found so far, fills the rest, and adds the strokes of
/// `proposals` (a curve from meeting to meeting at a time) and blobs that gain most for each pixel they take,
///   gain = Σ over the new pixels of [(I − fill)² − (I − patch)²] / (2 noise²) − coding_cost − ln(pixels of
///   the frame),
/// in luma, until none gains or the budget is spent. Additions do not overlap existing patches, but for the
/// meetings of strokes. Vertices are numbered anew, their types named, and carry their cost and gain.
/// `levels`: CV_32F, 1 or 3 channels. At most about 50 rounds of O(pixels).
graph::AttributeGraph pursue(const graph::AttributeGraph& proposals, const cv::Mat& levels,
                             const PursuitOptions& pursuit);

}  // namespace emberfold::sketch
