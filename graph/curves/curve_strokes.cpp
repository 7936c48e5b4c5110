// SPDX-License-Identifier: Apache-2.0
#include "graph/curves/curve_strokes.hpp"

#include <utility>

#include "graph/matching/match.hpp"

namespace emberfold::graph {

namespace {

AttributeGraph without_touches(const AttributeGraph& graph) {
  std::vector<Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  for (Vertex& vertex : vertices) vertex.subgraph = {vertex.curve.value};
  std::vector<Edge> edges;
  for (const Edge& edge : graph.edges()) {
    if (vertices[graph.index_of(edge.a)].curve == vertices[graph.index_of(edge.b)].curve)
      edges.push_back(edge);
  }
  return {std::move(vertices), std::move(edges), graph.memory()};
}

}  // namespace

MotionGraph curves_as_strokes(const MotionGraph& motion) {
  validate(motion);
  MotionGraph result{{motion.sketch.width, motion.sketch.height, motion.sketch.fps, {}}, motion.links};
  auto& frames = result.sketch.frames;
  for (const AttributeGraph& graph : motion.sketch.frames) frames.push_back(without_touches(graph));
  for (std::size_t t = 1; t < frames.size(); ++t)
    result.links[t] = supported_links(frames[t - 1], frames[t], std::move(result.links[t]));
  return result;
}

}  // namespace emberfold::graph
