// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/model_archive.hpp"
#include "graph/attribute_graph.hpp"
#include "sketch/background/background.hpp"
#include "sketch/background/level_clamp.hpp"

// The range of levels that a clip shows at each place. A stroke that leaves the place it was learned at must
// not take the levels of that place with it.
namespace emberfold::sketch {

/// Measures the range of one frame. `levels`: CV_32F, white = 255. O(pixels).
LevelRange measure_level_range(const cv::Mat& levels);
/// Widens `all` to what either range holds. Both cover one frame size; an empty one adds nothing.
void extend_level_range(LevelRange& all, const LevelRange& more);

/// Returns the graph with its patches' levels clamped to the range at their places. Both sides are clamped,
/// and the visible core of lines; between cells' middles the range is linear. A line keeps its height above
/// its sides as far as the range allows. A step loses contrast by as much as its sides are clamped.
graph::AttributeGraph clamp_levels(const graph::AttributeGraph& graph, const LevelRange& range);

/// Adds the arrays "seen_low" and "seen_high" to a motion model's archive; nothing for an empty range.
void add_level_range(core::ModelArchive& archive, const LevelRange& range);
/// Reads the range from an archive; empty where it has none. Throws core::IoError, naming the array, where
/// the arrays do not fit the frame.
LevelRange read_level_range(const core::ModelArchive& archive, cv::Size frame);

}  // namespace emberfold::sketch
