// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sites.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "graph/near.hpp"

namespace emberfold::mcmc {

namespace {

using graph::AttributeGraph;
using graph::Point;
using Index = std::uint32_t;

constexpr double in_line = std::numbers::pi / 6;

double turn(Point a, Point b) {
  return std::abs(std::atan2(a.x * b.y - a.y * b.x, graph::dot(a, b)));
}

// How far the curve turns at a vertex of degree 2.
double turn_at(const AttributeGraph& graph, Index v) {
  const auto sides = graph.neighbours(v);
  const Point at = graph.patch(v).position;
  return turn(at - graph.patch(sides[0]).position, graph.patch(sides[1]).position - at);
}

bool face_each_other(const AttributeGraph& graph, Index a, Index b) {
  const Point at_a = graph.patch(a).position, at_b = graph.patch(b).position, gap = at_b - at_a;
  const Point out_a = at_a - graph.patch(graph.neighbours(a)[0]).position,
              out_b = at_b - graph.patch(graph.neighbours(b)[0]).position;
  return turn(out_a, gap) < in_line && turn(gap, out_b * -1) < in_line;
}

void find_along(const AttributeGraph& graph, Sites& result) {
  for (Index v = 0; v < graph.size(); ++v) {
    const auto sides = graph.neighbours(v);
    if (sides.size() >= 3 || (sides.size() == 2 && turn_at(graph, v) >= in_line)) {
      for (const Index w : sides) result.arms.push_back({v, w});
    } else if (sides.size() == 2 && graph.degree(sides[0]) == 2 && graph.degree(sides[1]) == 2) {
      result.inner.push_back(v);
    }
  }
}

void find_between(const AttributeGraph& graph, const graph::Components& parts, Sites& result) {
  std::vector<Point> points;
  for (const auto& vertex : graph.vertices()) points.push_back(vertex.patch.position);
  const graph::detail::Near near(points, kReach);
  for (Index v = 0; v < graph.size(); ++v) {
    if (graph.degree(v) != 1) continue;
    std::map<Index, Index> nearest;  // of each other stroke
    std::set<Index> faced;
    for (const Index w : near.around(points[v])) {
      const Index part = parts.of_vertex[w];
      if (part == parts.of_vertex[v] || !graph::same_kind(graph.patch(v), graph.patch(w))) continue;
      if (graph.degree(w) == 1 && face_each_other(graph, v, w)) {
        faced.insert(part);
        if (v < w) result.facing.push_back({v, w});
      }
      const auto [known, is_new] = nearest.try_emplace(part, w);
      if (!is_new && graph::distance(points[v], points[w]) < graph::distance(points[v], points[known->second]))
        known->second = w;
    }
    for (const auto& [part, w] : nearest)
      if (!faced.contains(part)) result.beside.push_back({v, w});
  }
}

}  // namespace

Sites sites(const AttributeGraph& graph, const graph::Components& parts) {
  Sites result;
  find_along(graph, result);
  find_between(graph, parts, result);
  return result;
}

}  // namespace emberfold::mcmc
