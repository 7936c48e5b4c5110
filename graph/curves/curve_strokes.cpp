// SPDX-License-Identifier: Apache-2.0
#include "graph/curves/curve_strokes.hpp"

#include <utility>

#include "graph/matching/match.hpp"

namespace emberfold::graph {

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

}  // namespace emberfold::graph
