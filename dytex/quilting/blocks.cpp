// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/blocks.hpp"

#include <algorithm>
#include <utility>

namespace emberfold::dytex::detail {

std::vector<Run> overlap_runs(const QuiltBlock& block) {
  const cv::Size size = block.place.size();
  std::vector<Run> runs;
  for (int y = 0; y < size.height; ++y) {
    if (y < block.top || y >= size.height - block.bottom) {
      runs.push_back({0, y, size.width});
      continue;
    }
    if (block.left > 0) runs.push_back({0, y, block.left});
    if (block.right > 0) runs.push_back({size.width - block.right, y, block.right});
  }
  return runs;
}

int count_pixels(const std::vector<Run>& runs) {
  int count = 0;
  for (const Run& run : runs) count += run.length;
  return count;
}

std::vector<cv::Rect> run_boxes(const std::vector<Run>& runs) {
  std::vector<cv::Rect> boxes;
  for (const Run& run : runs) {
    const auto above = std::find_if(boxes.rbegin(), boxes.rend(), [&](const cv::Rect& box) {
      return box.x == run.x && box.width == run.length && box.y + box.height == run.y;
    });
    if (above != boxes.rend())
      ++above->height;
    else
      boxes.emplace_back(run.x, run.y, run.length, 1);
  }
  return boxes;
}

namespace {

struct Span {
  int begin = 0, length = 0;
};

std::vector<Span> place_blocks(int size, int block, int overlap, bool torus) {
  const int step = block - overlap;
  std::vector<Span> spans;
  if (!torus) {
    const int count = std::max(1, (size - overlap + step - 1) / step);
    for (int i = 0; i < count; ++i) spans.push_back({i * step, block});
    return spans;
  }
  const int count = std::max(2, (size + step - 1) / step);
  const auto begin = [&](int i) { return static_cast<int>(static_cast<long long>(i) * size / count); };
  for (int i = 0; i < count; ++i) spans.push_back({begin(i), begin(i + 1) - begin(i) + overlap});
  return spans;
}

}  // namespace

BlockPlan plan_blocks(cv::Size size, cv::Size block, int overlap, bool torus) {
  const auto columns = place_blocks(size.width, block.width, overlap, torus);
  const auto rows = place_blocks(size.height, block.height, overlap, torus);
  BlockPlan plan;
  plan.wraps = torus;
  plan.columns = static_cast<int>(columns.size());
  plan.rows = static_cast<int>(rows.size());
  plan.canvas = torus ? size : cv::Size(columns.back().begin + block.width, rows.back().begin + block.height);
  // A block needs the blocks to its left, above, and above on either side. On a torus the last column meets
  // the first one too, so that blocks go one by one there.
  const int turn = torus ? plan.columns : 2;
  plan.waves.resize(static_cast<std::size_t>(plan.columns - 1 + turn * (plan.rows - 1) + 1));
  for (int j = 0; j < plan.rows; ++j)
    for (int i = 0; i < plan.columns; ++i) {
      const Span& x = columns[static_cast<std::size_t>(i)];
      const Span& y = rows[static_cast<std::size_t>(j)];
      QuiltBlock made{i, j, {x.begin, y.begin, x.length, y.length}};
      if (i > 0) made.left = overlap;
      if (j > 0) made.top = overlap;
      if (torus && i == plan.columns - 1) made.right = overlap;
      if (torus && j == plan.rows - 1) made.bottom = overlap;
      plan.waves[static_cast<std::size_t>(i + turn * j)].push_back(made);
    }
  std::erase_if(plan.waves, [](const auto& wave) { return wave.empty(); });
  return plan;
}

}  // namespace emberfold::dytex::detail
