// SPDX-License-Identifier: Apache-2.0
#include "graph/curves/curve_strokes.hpp"

#include <algorithm>
#include <utility>

#include "graph/matching/match.hpp"

namespace emberfold::graph {

namespace {

/// Tells whether a curve has an end at which it touches another one.
bool has_branching_end(const AttributeGraph& graph, CurveId curve) {
  const auto is_own = [&](std::uint32_t v) { return graph.vertices()[v].curve == curve; };
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    const auto near = graph.neighbours(v);
    if (is_own(v) && !std::ranges::all_of(near, is_own) && std::ranges::count_if(near, is_own) <= 1)
      return true;
  }
  return false;
}

bool touch(const AttributeGraph& graph, CurveId a, CurveId b) {
  const auto curve = [&](VertexId id) { return graph.vertices()[graph.index_of(id)].curve; };
  return std::ranges::any_of(graph.edges(), [&](const Edge& edge) {
    const CurveId p = curve(edge.a), q = curve(edge.b);
    return (p == a && q == b) || (p == b && q == a);
  });
}

}  // namespace

AttributeGraph without_touches(const AttributeGraph& graph) {
  const auto stroke = [&](VertexId id) { return graph.vertices()[graph.index_of(id)].subgraph; };
  std::vector<Edge> edges;
  for (const Edge& edge : graph.edges())
    if (stroke(edge.a) == stroke(edge.b)) edges.push_back(edge);
  if (edges.size() == graph.edges().size()) return graph;
  return {{graph.vertices().begin(), graph.vertices().end()}, std::move(edges), graph.memory()};
}

MotionGraph curves_as_strokes(const MotionGraph& motion) {
  validate(motion);
  MotionGraph result{{motion.sketch.width, motion.sketch.height, motion.sketch.fps, {}}, motion.links};
  auto& frames = result.sketch.frames;
  for (const AttributeGraph& graph : motion.sketch.frames) {
    std::vector<SubgraphId> curves;
    for (const Vertex& vertex : graph.vertices()) curves.push_back({vertex.curve.value});
    frames.push_back(without_touches(graph.with_subgraphs(curves)));
  }
  for (std::size_t t = 1; t < frames.size(); ++t)
    result.links[t] = supported_links(frames[t - 1], frames[t], std::move(result.links[t]));
  return result;
}

bool changes_names_alone(const MotionGraph& motion, const Event& event) {
  if (event.after.size() == event.before.size()) return false;  // as another reading has it
  const bool is_more_after = event.after.size() > event.before.size();
  const auto& curves = is_more_after ? event.after : event.before;
  if (curves.empty()) return false;
  // The frame in which each of the curves is seen by itself.
  const auto t = static_cast<std::size_t>(is_more_after ? event.frame : event.frame - 1);
  const CurveId a{curves.front().value}, b{curves.back().value};
  if (curves.size() == 1) return has_branching_end(motion.sketch.frames[t], a);
  return a != b && touch(motion.sketch.frames[t], a, b);
}

}  // namespace emberfold::graph
