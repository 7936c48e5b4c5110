// SPDX-License-Identifier: Apache-2.0
// Conversion of a motion graph to a hidden graph, and back.
#include <algorithm>
#include <utility>

#include "core/error.hpp"
#include "graph/matching/match.hpp"
#include "graph/matching/point_grid.hpp"
#include "mcmc/sampler/hidden_graph.hpp"

namespace emberfold::mcmc {

namespace {

// Adds the patches of another sketch of the frame that overlap none of `nodes` (to which they are added), and
// its edges.
void add_others(HiddenGraph& state, const graph::AttributeGraph& other, int frame, std::vector<Index>& nodes,
                const Gates& gates) {
  std::vector<graph::Point> places;
  for (const Index i : nodes) places.push_back(state[i].patch.position);
  const graph::detail::PointGrid near(places, std::max(gates.overlap, 0.5));
  std::vector<Index> as;
  for (const auto& vertex : other.vertices()) {
    const graph::Point at = vertex.patch.position;
    Index nearest = kNone;
    for (const Index k : near.find_near(at))
      if (state[nodes[k]].kind == kind(vertex.patch) &&
          (nearest == kNone ||
           graph::distance(places[k], at) < graph::distance(state[nearest].patch.position, at)))
        nearest = nodes[k];
    as.push_back(nearest != kNone ? nearest : state.add_candidate(frame, vertex.patch));
  }
  for (const auto& edge : other.edges()) {
    const Index a = as[other.index_of(edge.a)], b = as[other.index_of(edge.b)];
    if (a != b) state.allow_edge(a, b);
  }
  for (const Index i : as)
    if (!state[i].active) nodes.push_back(i);
  std::ranges::sort(nodes);
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
}

}  // namespace

HiddenGraph hidden_graph(const graph::MotionGraph& start, std::span<const graph::SketchSequence> others,
                         const Gates& gates) {
  const auto& sketch = start.sketch;
  for (const auto& other : others)
    if (other.width != sketch.width || other.height != sketch.height ||
        other.frames.size() != sketch.frames.size())
      throw core::InputError("hidden graph: the starts are of different clips");
  HiddenGraph state(sketch.width, sketch.height, static_cast<int>(sketch.frames.size()), gates);
  std::vector<Index> before;
  for (std::size_t t = 0; t < sketch.frames.size(); ++t) {
    const auto frame = static_cast<int>(t);
    const auto& shown = sketch.frames[t];
    std::vector<Index> now;
    for (const auto& vertex : shown.vertices()) now.push_back(state.add_candidate(frame, vertex.patch));
    std::vector<Index> nodes = now;
    for (const Index i : now) state.activate(i);
    for (const auto& edge : shown.edges()) {
      const Index a = now[shown.index_of(edge.a)], b = now[shown.index_of(edge.b)];
      state.allow_edge(a, b);
      if (state.can_add_edge(a, b)) state.add_edge(a, b);
    }
    for (const auto& link : start.links[t]) {
      const auto& past = sketch.frames[t - 1];
      const Index v = before[past.index_of(link.before)], w = now[shown.index_of(link.after)];
      state.allow_link(v, w);
      if (state.can_link(v, w)) state.link(v, w);
    }
    for (const auto& other : others)
      add_others(state, graph::without_anchors(other.frames[t]), frame, nodes, gates);
    before = std::move(now);
  }
  return state;
}

graph::MotionGraph motion_graph(const HiddenGraph& state, double fps) {
  graph::MotionGraph motion;
  motion.sketch.width = state.width(), motion.sketch.height = state.height(), motion.sketch.fps = fps;
  std::vector<std::uint32_t> id(state.size());
  std::uint32_t next_id = 0;
  for (int t = 0; t < state.frames(); ++t) {
    std::vector<Index> shown(state.active(t).begin(), state.active(t).end());
    std::ranges::sort(shown);
    std::vector<graph::Vertex> vertices;
    std::vector<graph::Edge> edges;
    std::vector<graph::Link> links;
    for (const Index i : shown) {
      id[i] = next_id++;
      vertices.push_back({{id[i]}, {}, state[i].patch});
      for (const Index j : state[i].prev) links.push_back({{id[j]}, {id[i]}});
    }
    for (const Index i : shown)
      for (const Index j : state[i].edges)
        if (i < j) edges.push_back({{id[i]}, {id[j]}});
    std::ranges::sort(links);
    motion.sketch.frames.emplace_back(std::move(vertices), std::move(edges));
    if (t > 0) {
      const auto& frames = motion.sketch.frames;
      links = graph::supported_links(frames[frames.size() - 2], frames.back(), std::move(links));
    }
    motion.links.push_back(std::move(links));
  }
  return graph::identify(std::move(motion));
}

}  // namespace emberfold::mcmc
