// SPDX-License-Identifier: Apache-2.0
#include "pipeline/masked_sketch.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace emberfold::pipeline {

graph::AttributeGraph inside_mask(const graph::AttributeGraph& graph, const cv::Mat& mask) {
  if (mask.empty()) return graph;
  const auto inside = [&](std::size_t i) {
    const auto& at = graph.patch(i).position;
    const int x = std::clamp(static_cast<int>(std::lround(at.x)), 0, mask.cols - 1),
              y = std::clamp(static_cast<int>(std::lround(at.y)), 0, mask.rows - 1);
    return mask.at<std::uint8_t>(y, x) != 0;
  };
  // Drops a patch whose neighbours are all outside: it is no stroke of its own.
  std::vector<bool> stays;
  for (std::size_t i = 0; i < graph.size(); ++i)
    stays.push_back(inside(i) && (graph.degree(i) == 0 || std::ranges::any_of(graph.neighbours(i), inside)));
  return graph::induced_subgraph(graph, stays);
}

}  // namespace emberfold::pipeline
