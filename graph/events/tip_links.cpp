// SPDX-License-Identifier: Apache-2.0
#include "graph/events/tip_links.hpp"

#include <map>
#include <numeric>

#include "graph/matching/assignment.hpp"
#include "graph/matching/frame_links.hpp"

namespace emberfold::graph::detail {

namespace {

constexpr double kSearchReach = 20;  // px that a tip may lie from where it is looked for

std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t k) {
  while (parent[k] != k) k = parent[k] = parent[parent[k]];
  return k;
}

}  // namespace

FrameClusters cluster_frames(const AttributeGraph& before, const AttributeGraph& after,
                             std::span<const Link> links) {
  const Components a = components(before), b = components(after);
  std::vector<std::uint32_t> parent(a.count + b.count);
  std::iota(parent.begin(), parent.end(), 0U);
  const auto first_after = static_cast<std::uint32_t>(a.count);
  for (const auto& [i, j] : index_links(before, after, links).links)
    parent[root_of(parent, first_after + b.of_vertex[j])] = root_of(parent, a.of_vertex[i]);
  std::vector<std::uint32_t> number(parent.size(), Components::kNone);
  FrameClusters clusters;
  const auto cluster_of = [&](std::uint32_t part) {
    std::uint32_t& given = number[root_of(parent, part)];
    if (given == Components::kNone) given = static_cast<std::uint32_t>(clusters.count++);
    return given;
  };
  for (const std::uint32_t part : a.of_vertex) clusters.of_before.push_back(cluster_of(part));
  for (const std::uint32_t part : b.of_vertex) clusters.of_after.push_back(cluster_of(first_after + part));
  return clusters;
}

std::vector<std::uint32_t> tips_of(const AttributeGraph& graph) {
  std::vector<std::uint32_t> tips;
  for (std::uint32_t v = 0; v < graph.size(); ++v)
    if (graph.degree(v) == 1) tips.push_back(v);
  return tips;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> link_tips(const AttributeGraph& before,
                                                               const AttributeGraph& after,
                                                               std::span<const Link> links,
                                                               const FrameClusters& clusters) {
  std::map<std::uint32_t, Point> expected;  // by tip before
  for (const std::uint32_t tip : tips_of(before)) expected[tip] = before.patch(tip).position;
  for (const auto& [i, j] : index_links(before, after, links).links)
    if (const auto at = expected.find(i); at != expected.end()) at->second = after.patch(j).position;
  std::multimap<std::uint32_t, std::uint32_t> tips_after;  // by cluster
  for (const std::uint32_t tip : tips_of(after)) tips_after.emplace(clusters.of_after[tip], tip);
  std::vector<Candidate> candidates;
  for (const auto& [tip, place] : expected) {
    const auto [first, last] = tips_after.equal_range(clusters.of_before[tip]);
    for (auto at = first; at != last; ++at) {
      const double apart = distance(after.patch(at->second).position, place);
      if (apart < kSearchReach) candidates.push_back({tip, at->second, kSearchReach - apart});
    }
  }
  return assign(candidates);
}

std::vector<std::uint32_t> way_from_tip(const AttributeGraph& graph, std::uint32_t tip) {
  std::vector<std::uint32_t> way{tip};
  for (std::uint32_t last = tip;;) {
    const std::uint32_t here = way.back();
    const auto near = graph.neighbours(here);
    if (near.empty() || (way.size() > 1 && near.size() != 2)) return way;
    const std::uint32_t next = way.size() > 1 && near[0] == last ? near[1] : near[0];
    last = here;
    way.push_back(next);
  }
}

}  // namespace emberfold::graph::detail
