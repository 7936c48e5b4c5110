// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/stroke_places.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace emberfold::mcmc {

using graph::Point;

namespace {
constexpr double kEqual = 1e-6;  // px
}  // namespace

std::vector<std::vector<std::uint32_t>> vertices_by_stroke(const graph::Components& parts) {
  std::vector<std::vector<std::uint32_t>> result(parts.count);
  for (std::uint32_t v = 0; v < parts.of_vertex.size(); ++v) result[parts.of_vertex[v]].push_back(v);
  return result;
}

Point stroke_middle(const graph::AttributeGraph& graph, std::span<const std::uint32_t> stroke) {
  Point mean;
  for (const auto v : stroke) mean = mean + graph.patch(v).position;
  mean = mean * (1.0 / static_cast<double>(stroke.size()));
  const auto away = [&](std::uint32_t v) { return graph::distance(graph.patch(v).position, mean); };
  const auto nearest = std::ranges::min_element(stroke, {}, away);
  // Both patches of a pair are equally near: the last digits must not choose.
  const auto first = std::ranges::find_if(stroke, [&](auto v) { return away(v) <= away(*nearest) + kEqual; });
  return graph.patch(*first).position;
}

double gap_between_strokes(const graph::AttributeGraph& graph, graph::SubgraphId a, graph::SubgraphId b) {
  std::vector<Point> one, other;
  for (const auto& v : graph.vertices()) {
    if (v.subgraph == a) one.push_back(v.patch.position);
    if (v.subgraph == b) other.push_back(v.patch.position);
  }
  double nearest = std::numeric_limits<double>::infinity();
  for (const Point p : one)
    for (const Point q : other) nearest = std::min(nearest, graph::dot(p - q, p - q));
  return std::sqrt(nearest);
}

}  // namespace emberfold::mcmc
