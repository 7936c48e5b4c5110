// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <opencv2/core/mat.hpp>

#include "graph/attribute_graph.hpp"
#include "sketch/refinement/coding_length.hpp"

namespace emberfold::sketch {

/// Holds the settings of refine().
struct RefineOptions {
  double spacing = 5;  ///< px from patch to patch, ≥ 2
};

/// Runs phase II of the sketch pursuit (Guo, Zhu & Wu 2007), which edits the graph.
/// An edit is made where it shortens the frame's code (EditableGraph). The greatest change comes first, until
/// none shortens. The edits:
/// - strokes are deleted;
/// - ends grow and shrink, meet other ends, go on to another stroke, or meet in a corner; the patches of two
///   ends become one;
/// - a faded middle of a stroke is cut out; neighbouring junctions become one; two parallel steps become a
///   bar.
/// Each may bring several patches at once and is judged as a whole. New patches show at least half of the
/// contrast of those they continue, and do not overlap others. `graph`: of `levels` (CV_32F, 1 or 3
/// channels), prepared as `axes`: luma first; a patch has its gain of the axis where that is greatest. Every
/// patch comes back with its cost and gain. O(patches · log) a round, at most 4 rounds.
graph::AttributeGraph refine(const graph::AttributeGraph& graph, const cv::Mat& levels,
                             std::span<const CodingContext> axes, const RefineOptions& refinement);

}  // namespace emberfold::sketch
