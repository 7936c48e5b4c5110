// SPDX-License-Identifier: Apache-2.0
// Small graphs for tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/rng.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::test {

inline graph::Vertex vertex(std::uint32_t id, double x, double y, double theta = 0, double contrast = 40) {
  graph::Vertex v;
  v.id = {id};
  v.patch.type = contrast > 0 ? graph::PatchType::ridge : graph::PatchType::valley;
  v.patch.position = {x, y};
  v.patch.theta = theta;
  v.patch.width = 2;
  v.patch.contrast = contrast;
  v.patch.left = v.patch.right = {100, 100, 100};
  v.patch.middle.fill(static_cast<float>(100 + contrast));
  return v;
}

inline graph::Vertex anchor(std::uint32_t id, double x, double y, const graph::Level& level = {90, 90, 90}) {
  return {{id}, {}, graph::make_anchor({x, y}, level)};
}

/// The graph with so many anchors after its other vertices, at random pixels of 320 × 240.
inline graph::AttributeGraph with_anchors(const graph::AttributeGraph& graph, core::Rng& rng,
                                          std::uint32_t count) {
  std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  const std::uint32_t first = vertices.empty() ? 0 : vertices.back().id.value + 1;
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto grey = static_cast<float>(rng.uniform(0, 255));
    vertices.push_back(
        anchor(first + k, rng.below(320), rng.below(240), {grey, grey, rng.below(2) == 0 ? grey : grey + 1}));
  }
  return {std::move(vertices), {graph.edges().begin(), graph.edges().end()}};
}

/// A frame put together from polylines with a vertex at every point, and further edges.
struct Frame {
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;

  /// Adds a polyline and returns the id of its first vertex; the others follow on.
  std::uint32_t line(const std::vector<graph::Point>& points, double contrast = 40) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (std::size_t k = 0; k < points.size(); ++k) {
      const graph::Point d = points[std::min(k + 1, points.size() - 1)] - points[k > 0 ? k - 1 : 0];
      const auto id = static_cast<std::uint32_t>(first + k);
      vertices.push_back(vertex(id, points[k].x, points[k].y, std::atan2(d.y, d.x), contrast));
      if (k > 0) edges.push_back({{id - 1}, {id}});
    }
    return first;
  }
  void edge(std::uint32_t a, std::uint32_t b) { edges.push_back({{a}, {b}}); }
  [[nodiscard]] graph::AttributeGraph graph() const { return {vertices, edges}; }
};

/// Points from a to b, the last one at b, `count` in all.
inline std::vector<graph::Point> segment(graph::Point a, graph::Point b, int count) {
  std::vector<graph::Point> points;
  for (int k = 0; k < count; ++k) points.push_back(a + (b - a) * (count > 1 ? k / (count - 1.0) : 0.0));
  return points;
}

/// A sequence of frames with links given by vertex numbers within their frames.
inline graph::MotionGraph motion(
    const std::vector<graph::AttributeGraph>& frames,
    const std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>>& links) {
  graph::MotionGraph result;
  result.sketch.width = 320;
  result.sketch.height = 240;
  for (const auto& frame : frames) result.sketch.append(frame);
  for (std::size_t t = 0; t < frames.size(); ++t) {
    result.links.emplace_back();
    if (t == 0) continue;
    for (const auto& [i, j] : links.at(t - 1)) {
      result.links[t].push_back(
          {result.sketch.frames[t - 1].vertices()[i].id, result.sketch.frames[t].vertices()[j].id});
    }
    std::sort(result.links[t].begin(), result.links[t].end());
  }
  return result;
}

/// A random graph of paths with some bridges, and random attributes.
inline graph::AttributeGraph random_graph(core::Rng& rng, std::uint32_t paths, std::uint32_t bridges) {
  Frame frame;
  for (std::uint32_t p = 0; p < paths; ++p) {
    const graph::Point a{rng.uniform(0, 300), rng.uniform(0, 200)};
    const graph::Point b{a.x + rng.uniform(-40, 40), a.y + rng.uniform(-40, 40)};
    frame.line(segment(a, b, static_cast<int>(1 + rng.below(8))), rng.uniform() < 0.5 ? 30 : -30);
  }
  const auto n = static_cast<std::uint32_t>(frame.vertices.size());
  for (std::uint32_t k = 0; k < bridges && n > 1; ++k) {
    const std::uint32_t a = rng.below(n), b = rng.below(n);
    const bool there = std::any_of(frame.edges.begin(), frame.edges.end(), [&](const graph::Edge& e) {
      return (e.a.value == a && e.b.value == b) || (e.a.value == b && e.b.value == a);
    });
    if (a != b && !there) frame.edge(a, b);
  }
  for (auto& v : frame.vertices) {
    v.patch.type =
        static_cast<graph::PatchType>(rng.below(static_cast<std::uint32_t>(graph::PatchType::anchor)));
    v.patch.blur = rng.uniform(0.5, 3);
    v.patch.theta = rng.uniform(-3.1, 3.1);
    for (float& value : v.patch.left) value = static_cast<float>(rng.uniform(0, 255));
    if (rng.uniform() < 0.5) v.patch.middle.fill(static_cast<float>(rng.uniform(-1e-3, 255)));
  }
  return frame.graph();
}

/// Random links between two frames that are a star forest, by vertex number.
inline std::vector<std::pair<std::uint32_t, std::uint32_t>> random_links(core::Rng& rng, std::size_t before,
                                                                         std::size_t after, int tries) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
  if (before == 0 || after == 0) return links;
  const auto uses = [&](auto same) { return std::count_if(links.begin(), links.end(), same); };
  for (int k = 0; k < tries; ++k) {
    const std::uint32_t i = rng.below(static_cast<std::uint32_t>(before));
    const std::uint32_t j = rng.below(static_cast<std::uint32_t>(after));
    links.emplace_back(i, j);
    bool star = true;
    for (const auto& [a, b] : links) {
      const auto of_a = uses([a = a](const auto& l) { return l.first == a; });
      const auto of_b = uses([b = b](const auto& l) { return l.second == b; });
      star = star && !(of_a > 1 && of_b > 1);
    }
    if (!star) links.pop_back();
  }
  return links;
}

/// A random motion graph, not identified.
inline graph::MotionGraph random_motion(std::uint64_t seed, int frames, int tries) {
  core::Rng rng(seed);
  std::vector<graph::AttributeGraph> graphs;
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> links;
  for (int t = 0; t < frames; ++t) {
    graphs.push_back(random_graph(rng, rng.below(6), rng.below(3)));
    if (t > 0)
      links.push_back(random_links(rng, graphs[graphs.size() - 2].size(), graphs.back().size(), tries));
  }
  return motion(graphs, links);
}

}  // namespace emberfold::test
