// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/types.hpp>

/// Layout of a quilt's blocks. Inner header of quilting.
namespace emberfold::dytex::detail {

/// One block of the output, and the strips along its sides (px wide, 0: none) that overlap earlier blocks.
struct QuiltBlock {
  int column = 0, row = 0;
  cv::Rect place;  ///< on the canvas; where that wraps, it may reach beyond its right and lower border
  int left = 0, top = 0, right = 0, bottom = 0;
};

/// Pixels of one row of a block that overlap earlier blocks.
struct Run {
  int x = 0, y = 0, length = 0;
};
/// Lists the runs of a block row by row, from left to right.
std::vector<Run> overlap_runs(const QuiltBlock& block);
int count_pixels(const std::vector<Run>& runs);
/// Returns runs, given row by row, as rectangles that share no pixels.
std::vector<cv::Rect> run_boxes(const std::vector<Run>& runs);

struct BlockPlan {
  cv::Size canvas;     ///< at least the output's size; the excess is cut off at the end
  bool wraps = false;  ///< the canvas is a torus
  int columns = 0, rows = 0;
  /// Blocks of one wave touch none of each other's pixels and need those of the waves before.
  std::vector<std::vector<QuiltBlock>> waves;
};

/// Places blocks every block − overlap pixels, from the upper left. On a torus they are spread evenly, none
/// larger than `block`, each overlapping its neighbours by `overlap`. Needs 1 ≤ overlap ≤ block / 2, on a
/// torus size ≥ 2 · overlap.
BlockPlan plan_blocks(cv::Size size, cv::Size block, int overlap, bool torus);

}  // namespace emberfold::dytex::detail
