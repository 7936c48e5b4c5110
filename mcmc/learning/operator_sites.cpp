// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/operator_sites.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "graph/events/joints.hpp"
#include "graph/matching/point_grid.hpp"

namespace emberfold::mcmc {

namespace {

using graph::AttributeGraph;
using graph::Point;
using Index = std::uint32_t;

constexpr double in_line = std::numbers::pi / 6;

double angle_between(Point a, Point b) {
  return std::abs(std::atan2(a.x * b.y - a.y * b.x, graph::dot(a, b)));
}

bool face_each_other(const AttributeGraph& graph, Index a, Index b) {
  const Point gap = graph.patch(b).position - graph.patch(a).position;
  return angle_between(end_direction(graph, a), gap) < in_line &&
         angle_between(gap, end_direction(graph, b) * -1) < in_line;
}

// The direction in which a curve would end at its k-th patch, coming from the left (step 1) or from the right
// (−1).
Point tip_direction_at(const AttributeGraph& graph, const std::vector<Index>& curve, std::size_t k,
                       int step) {
  const auto at = [&](std::size_t i) { return graph.patch(curve[i]).position; };
  std::vector<Point> way{at(k)};
  const std::size_t last = step > 0 ? 0 : curve.size() - 1;
  for (double walked = 0; walked < graph::detail::kTipReach && k != last;) {
    k = step > 0 ? k - 1 : k + 1;
    walked += graph::distance(way.back(), at(k));
    way.push_back(at(k));
  }
  return graph::detail::tip_direction(way);
}

// True if a curve without its i-th patch, or without some more to both sides, reads as a line with a gap in
// it (graph/events/joints.hpp).
bool splits(const AttributeGraph& graph, const std::vector<Index>& curve, std::size_t i) {
  return std::ranges::all_of(std::array<std::size_t, 2>{1, 3}, [&](std::size_t wide) {
    const std::size_t a = i - std::min(i, wide), b = std::min(curve.size() - 1, i + wide);
    const Point gap = graph.patch(curve[b]).position - graph.patch(curve[a]).position;
    // A single patch that ends in the gap has no direction of its own.
    const Point out = a > 0 ? tip_direction_at(graph, curve, a, 1) : gap,
                in = b + 1 < curve.size() ? tip_direction_at(graph, curve, b, -1) : gap * -1;
    return angle_between(out, gap) < in_line && angle_between(gap * -1, in) < in_line;
  });
}

void find_along(const AttributeGraph& graph, OperatorSites& result) {
  for (const auto& curve : graph::curves(graph)) {
    const std::size_t n = curve.size();
    const bool ring = n > 1 && curve.front() == curve.back();
    const auto free = [&](Index end) { return !ring && graph.degree(end) == 1; };
    // Patches that must lie between the i-th and the free end before it, or behind it.
    const std::size_t before = free(curve.front()) ? 0 : kPiece, behind = free(curve.back()) ? 0 : kPiece;
    const auto whole = [&](std::size_t i) { return i + before >= kPiece && n - 1 - i + behind >= kPiece; };
    if (n > 1 && graph.degree(curve.front()) >= 3 && whole(0))
      result.disconnect_sites.push_back({curve[0], curve[1]});
    if (n > 1 && graph.degree(curve.back()) >= 3 && whole(n - 1))
      result.disconnect_sites.push_back({curve[n - 1], curve[n - 2]});
    for (std::size_t i = 1; i + 1 < n; ++i) {
      if (!whole(i)) continue;
      const Point at = graph.patch(curve[i]).position;
      const bool corner = angle_between(at - graph.patch(curve[i - 1]).position,
                                        graph.patch(curve[i + 1]).position - at) >= in_line;
      if (!corner && splits(graph, curve, i)) {
        result.split_sites.push_back(curve[i]);
      } else if (corner) {
        result.disconnect_sites.push_back({curve[i], curve[i - 1]});
        result.disconnect_sites.push_back({curve[i], curve[i + 1]});
      }
    }
  }
  std::ranges::sort(result.split_sites);
  std::ranges::sort(result.disconnect_sites);
}

// Nearest patch of another stroke to an end.
struct Approach {
  OperatorSites::Pair pair;
  double distance = 0;
  bool facing = false;
  // Ends in line come before others, then the nearest.
  [[nodiscard]] bool before(const Approach& other) const {
    return facing != other.facing ? facing : distance < other.distance;
  }
};

void find_between(const AttributeGraph& graph, const graph::Components& parts, double reach,
                  OperatorSites& result) {
  std::vector<Point> points;
  for (const auto& vertex : graph.vertices()) points.push_back(vertex.patch.position);
  const graph::detail::PointGrid near(points, reach);
  std::map<std::pair<Index, Index>, Approach> nearest;  // of two strokes
  for (Index v = 0; v < graph.size(); ++v) {
    if (graph.degree(v) != 1) continue;
    const Index own = parts.of_vertex[v];
    for (const Index w : near.find_near(points[v])) {
      const Index other = parts.of_vertex[w];
      if (other == own || !graph::same_kind(graph.patch(v), graph.patch(w))) continue;
      const Approach found{{v, w},
                           graph::distance(points[v], points[w]),
                           graph.degree(w) == 1 && face_each_other(graph, v, w)};
      const auto [known, is_new] = nearest.try_emplace(std::minmax(own, other), found);
      if (!is_new && found.before(known->second)) known->second = found;
    }
  }
  for (const auto& [both, approach] : nearest)
    (approach.facing ? result.merge_sites : result.connect_sites).push_back(approach.pair);
  std::ranges::sort(result.merge_sites);
  std::ranges::sort(result.connect_sites);
}

}  // namespace

OperatorSites find_sites(const AttributeGraph& graph, const graph::Components& parts, double reach) {
  OperatorSites result;
  find_along(graph, result);
  find_between(graph, parts, reach, result);
  return result;
}

Point end_direction(const AttributeGraph& graph, Index end) {
  return graph.patch(end).position - graph.patch(graph.neighbours(end)[0]).position;
}

double turn_angle_towards(const AttributeGraph& graph, const OperatorSites::Pair& pair) {
  if (graph.degree(pair.a) == 0) return 0;
  return angle_between(end_direction(graph, pair.a),
                       graph.patch(pair.b).position - graph.patch(pair.a).position);
}

}  // namespace emberfold::mcmc
