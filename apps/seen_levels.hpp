// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/model_archive.hpp"
#include "graph/attribute_graph.hpp"

// Which levels a clip has where: a stroke that has left the place it was learned at must not take the levels
// of that place with it.
namespace emberfold::apps {

/// The darkest and the brightest level within kSeenCell px of each cell's middle (both ways, a square),
/// channel by channel; a cell is kSeenCell px wide. No cells where it is not known.
constexpr int kSeenCell = 8;
struct SeenLevels {
  cv::Mat low, high;  ///< CV_8U, 1 or 3 channels, a cell each
  [[nodiscard]] bool empty() const { return low.empty(); }
};

/// Of one frame. `levels`: CV_32F, white = 255.
SeenLevels measure_seen(const cv::Mat& levels);
/// What was seen in either; of one size, or none.
void add_seen(SeenLevels& all, const SeenLevels& more);

/// The graph with the sides of its patches, and what is seen of lines' cores, within what was seen there,
/// linear between the cells' middles. A line keeps its height above its sides as far as that allows; a step
/// loses what its sides must give way.
graph::AttributeGraph within(const graph::AttributeGraph& graph, const SeenLevels& seen);

/// The arrays "seen_low" and "seen_high" beside a motion model's own.
void add_seen_levels(core::ModelArchive& archive, const SeenLevels& seen);
/// Empty where the archive has none; core::IoError, naming the array, where they do not fit the frame.
SeenLevels read_seen_levels(const core::ModelArchive& archive, cv::Size frame);

}  // namespace emberfold::apps
