// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/model_archive.hpp"
#include "graph/attribute_graph.hpp"

// Which levels a clip has where: a stroke that has left the place it was learned at must not take the levels
// of that place with it.
namespace emberfold::sketch {

/// The darkest and the brightest level within kLevelRangeCell px of each cell's middle (both ways, a square),
/// channel by channel; a cell is kLevelRangeCell px wide. No cells where it is not known.
constexpr int kLevelRangeCell = 8;
struct LevelRange {
  cv::Mat low, high;  ///< CV_8U, 1 or 3 channels, a cell each
  [[nodiscard]] bool empty() const { return low.empty(); }
};

/// Of one frame. `levels`: CV_32F, white = 255.
LevelRange measure_level_range(const cv::Mat& levels);
/// What was seen in either; of one size, or none.
void extend_level_range(LevelRange& all, const LevelRange& more);

/// The graph with the sides of its patches, and what is seen of lines' cores, within what was seen there,
/// linear between the cells' middles. A line keeps its height above its sides as far as that allows; a step
/// loses what its sides must give way.
graph::AttributeGraph clamp_levels(const graph::AttributeGraph& graph, const LevelRange& range);

/// The arrays "seen_low" and "seen_high" beside a motion model's own.
void add_level_range(core::ModelArchive& archive, const LevelRange& range);
/// Empty where the archive has none; core::IoError, naming the array, where they do not fit the frame.
LevelRange read_level_range(const core::ModelArchive& archive, cv::Size frame);

}  // namespace emberfold::sketch
