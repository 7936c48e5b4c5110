// SPDX-License-Identifier: Apache-2.0
#include "graph/network/network_figures.hpp"

#include <algorithm>
#include <cmath>

#include "graph/events/events.hpp"

namespace emberfold::graph {

namespace {

/// The directed edges of a graph: those out of each vertex, by direction.
class HalfEdges {
 public:
  explicit HalfEdges(const AttributeGraph& graph) : graph_(graph), first_(graph.size() + 1, 0) {
    for (std::uint32_t v = 0; v < graph.size(); ++v) {
      first_[v] = to_.size();
      const auto near = graph.neighbours(v);
      to_.insert(to_.end(), near.begin(), near.end());
      const Point here = graph.patch(v).position;
      const auto direction = [&](std::uint32_t w) {
        const Point way = graph.patch(w).position - here;
        return std::atan2(way.y, way.x);
      };
      std::sort(to_.begin() + static_cast<std::ptrdiff_t>(first_[v]), to_.end(),
                [&](std::uint32_t a, std::uint32_t b) {
                  const double of_a = direction(a), of_b = direction(b);
                  return of_a != of_b ? of_a < of_b : a < b;
                });
    }
    first_.back() = to_.size();
  }

  /// Returns the areas of all faces; those that are bounded are above 0.
  [[nodiscard]] std::vector<double> face_areas() const {
    std::vector<double> areas;
    std::vector<bool> seen(to_.size(), false);
    for (std::uint32_t v = 0; v < graph_.size(); ++v) {
      for (std::size_t start = first_[v]; start < first_[v + 1]; ++start) {
        double area = 0;
        std::uint32_t from = v;
        for (std::size_t edge = start; !seen[edge];) {
          seen[edge] = true;
          const Point a = graph_.patch(from).position, b = graph_.patch(to_[edge]).position;
          area += (a.x * b.y - b.x * a.y) / 2;
          const std::uint32_t at = to_[edge];
          edge = next_after(at, from);
          from = at;
        }
        areas.push_back(area);
      }
    }
    return areas;
  }

 private:
  /// Returns the edge out of `at` that follows, against the order of directions, the one back to `from`.
  [[nodiscard]] std::size_t next_after(std::uint32_t at, std::uint32_t from) const {
    const std::size_t begin = first_[at], end = first_[at + 1];
    std::size_t edge = begin;
    while (to_[edge] != from) ++edge;
    return edge == begin ? end - 1 : edge - 1;
  }

  const AttributeGraph& graph_;
  std::vector<std::size_t> first_;
  std::vector<std::uint32_t> to_;
};

double edge_length(const AttributeGraph& graph, std::uint32_t a, std::uint32_t b) {
  return distance(graph.patch(a).position, graph.patch(b).position);
}

double tortuosity_of(const AttributeGraph& graph) {
  double paths = 0, chords = 0;
  for (const Curve& curve : curves(graph)) {
    const double chord = edge_length(graph, curve.front(), curve.back());
    if (chord == 0) continue;
    chords += chord;
    for (std::size_t k = 1; k < curve.size(); ++k) paths += edge_length(graph, curve[k - 1], curve[k]);
  }
  return chords > 0 ? paths / chords : 1;
}

}  // namespace

NetworkFigures network_figures(const AttributeGraph& graph) {
  constexpr double kLeastMesh = 1e-6;  // px²: rounding in a face without area
  const AttributeGraph lines = without_anchors(graph);
  const Components parts = components(lines);
  NetworkFigures figures;
  figures.components = static_cast<std::uint32_t>(parts.count);
  std::vector<double> lengths(parts.count, 0);
  for (std::uint32_t v = 0; v < lines.size(); ++v) {
    const std::size_t degree = lines.degree(v);
    figures.points += degree == 0 ? 1 : 0;
    figures.tips += degree == 1 ? 1 : 0;
    figures.junctions_3 += degree == 3 ? 1 : 0;
    figures.junctions_4 += degree == 4 ? 1 : 0;
    figures.junctions_more += degree > 4 ? 1 : 0;
    figures.branches += degree > 2 ? static_cast<std::uint32_t>(degree - 2) : 0;
    for (const std::uint32_t w : lines.neighbours(v))
      if (v < w && is_seen(lines.patch(v), lines.patch(w)))
        lengths[parts.of_vertex[v]] += edge_length(lines, v, w);
  }
  for (const double length : lengths)
    figures.length += length, figures.longest = std::max(figures.longest, length);
  figures.loops = static_cast<std::uint32_t>(lines.edges().size() + parts.count - lines.size());
  for (const double area : HalfEdges(lines).face_areas())
    if (area > kLeastMesh) figures.meshes.push_back(area);
  std::sort(figures.meshes.begin(), figures.meshes.end());
  figures.tortuosity = tortuosity_of(lines);
  return figures;
}

std::vector<NetworkChanges> network_changes(const MotionGraph& motion) {
  std::vector<NetworkChanges> changes(motion.sketch.frames.size());
  for (const Event& event : stroke_events(motion)) {
    NetworkChanges& frame = changes[static_cast<std::size_t>(event.frame)];
    switch (event.type) {
      case EventType::birth:
        ++frame.births;
        break;
      case EventType::death:
        ++frame.deaths;
        break;
      case EventType::merge:
      case EventType::connect:
        ++frame.unions;
        break;
      default:
        ++frame.separations;
    }
  }
  return changes;
}

}  // namespace emberfold::graph
