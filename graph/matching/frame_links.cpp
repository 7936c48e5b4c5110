// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/frame_links.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace emberfold::graph::detail {

FrameLinks index_links(const AttributeGraph& before, const AttributeGraph& after,
                       std::span<const Link> links) {
  FrameLinks result;
  result.links.reserve(links.size());
  result.successors.assign(before.size(), 0);
  result.predecessors.assign(after.size(), 0);
  for (const Link& link : links) {
    const std::size_t i = before.index_of(link.before), j = after.index_of(link.after);
    result.links.emplace_back(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j));
    ++result.successors[i];
    ++result.predecessors[j];
  }
  return result;
}

LinkPartners::LinkPartners(const FrameLinks& links)
    : successors(links.successors.size()), predecessors(links.predecessors.size()) {
  for (const auto& [i, j] : links.links) add(i, j);
}

bool LinkPartners::admit(std::size_t before, std::size_t after) const {
  const auto &of_before = successors[before], &of_after = predecessors[after];
  if (!of_before.empty() && !of_after.empty()) return false;
  return std::ranges::all_of(of_before, [&](std::uint32_t w) { return predecessors[w].size() == 1; }) &&
         std::ranges::all_of(of_after, [&](std::uint32_t v) { return successors[v].size() == 1; });
}

void LinkPartners::add(std::size_t before, std::size_t after) {
  successors[before].push_back(static_cast<std::uint32_t>(after));
  predecessors[after].push_back(static_cast<std::uint32_t>(before));
}

std::vector<ComponentPair> component_pairs(const AttributeGraph& before, const AttributeGraph& after,
                                           const Components& parts_before, const Components& parts_after,
                                           const FrameLinks& links) {
  std::vector<ComponentPair> pairs;
  pairs.reserve(links.links.size());
  for (const auto& [i, j] : links.links) {
    const Point middle = (before.patch(i).position + after.patch(j).position) * 0.5;
    pairs.push_back({parts_before.of_vertex[i], parts_after.of_vertex[j], 1, middle});
  }
  std::sort(pairs.begin(), pairs.end(), [](const ComponentPair& a, const ComponentPair& b) {
    return std::tie(a.before, a.after, a.first.x, a.first.y) <
           std::tie(b.before, b.after, b.first.x, b.first.y);
  });
  std::vector<ComponentPair> result;
  for (const ComponentPair& pair : pairs) {
    if (!result.empty() && result.back().before == pair.before && result.back().after == pair.after) {
      ++result.back().links;
    } else {
      result.push_back(pair);
    }
  }
  return result;
}

Point mean_displacement(const MotionGraph& motion, SubgraphId stroke, std::size_t from, std::size_t to) {
  if (from == to) return {};
  const AttributeGraph &a = motion.sketch.frames[from], &b = motion.sketch.frames[to];
  std::vector<std::pair<double, double>> ways;
  for (const Link& link : motion.links[std::max(from, to)]) {
    const auto [before, after] = std::pair(link.before, link.after);
    const Vertex &p = a.vertices()[a.index_of(from < to ? before : after)],
                 &q = b.vertices()[b.index_of(from < to ? after : before)];
    if (p.subgraph != stroke || q.subgraph != stroke) continue;
    const Point way = q.patch.position - p.patch.position;
    ways.emplace_back(way.x, way.y);
  }
  std::sort(ways.begin(), ways.end());
  Point sum;
  for (const auto& [x, y] : ways) sum = sum + Point{x, y};
  return ways.empty() ? Point{} : sum * (1 / static_cast<double>(ways.size()));
}

}  // namespace emberfold::graph::detail
