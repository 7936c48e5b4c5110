// SPDX-License-Identifier: Apache-2.0
// Conversion of a motion graph to a hidden graph, and back.
#include <algorithm>
#include <optional>
#include <utility>

#include "core/error.hpp"
#include "graph/matching/match.hpp"
#include "graph/matching/point_grid.hpp"
#include "mcmc/sampler/hidden_graph.hpp"

namespace emberfold::mcmc {

namespace {

/// The candidates of a start's patches, by frame and vertex.
using StartNodes = std::vector<std::vector<Index>>;

/// Returns the candidate of each patch of a frame: one of `known` that it overlaps, each for one patch, or a
/// new one, which becomes known.
std::vector<Index> add_patches(HiddenGraph& state, const graph::AttributeGraph& shown, int frame,
                               std::vector<Index>& known, const Gates& gates) {
  std::vector<graph::Point> places;
  for (const Index i : known) places.push_back(state[i].patch.position);
  const graph::detail::PointGrid near(places, std::max(gates.overlap, 0.5));
  std::vector<bool> is_taken(places.size(), false);
  std::vector<Index> nodes;
  for (const auto& vertex : shown.vertices()) {
    const auto apart = [&](std::size_t k) { return graph::distance(places[k], vertex.patch.position); };
    std::optional<std::size_t> nearest;
    for (const std::size_t k : near.find_near(vertex.patch.position))
      if (!is_taken[k] && state[known[k]].kind == kind(vertex.patch) && apart(k) < gates.overlap &&
          (!nearest || apart(k) < apart(*nearest)))
        nearest = k;
    if (nearest) is_taken[*nearest] = true;
    nodes.push_back(nearest ? known[*nearest] : state.add_candidate(frame, vertex.patch));
    if (!nearest) known.push_back(nodes.back());
  }
  return nodes;
}

/// Visits the edges of a start and then its links, as pairs of candidates.
template <class Edge, class Link>
void visit_edges_and_links(const graph::MotionGraph& start, const StartNodes& nodes, const Edge& edge,
                           const Link& link) {
  const auto& frames = start.sketch.frames;
  for (std::size_t t = 0; t < frames.size(); ++t) {
    for (const auto& e : frames[t].edges())
      edge(nodes[t][frames[t].index_of(e.a)], nodes[t][frames[t].index_of(e.b)]);
    for (const auto& l : start.links[t])
      link(nodes[t - 1][frames[t - 1].index_of(l.before)], nodes[t][frames[t].index_of(l.after)]);
  }
}

/// Allows all that a start has.
void allow(HiddenGraph& state, const graph::MotionGraph& start, const StartNodes& nodes) {
  visit_edges_and_links(
      start, nodes, [&](Index a, Index b) { state.allow_edge(a, b); },
      [&](Index v, Index w) { state.allow_link(v, w); });
  for (const auto& shown : nodes)
    for (const Index a : shown)
      for (const NeighbourCandidate& near : state.neighbours(a))
        if (a < near.node && state.overlaps(a, near.node) &&
            std::ranges::find(shown, near.node) != shown.end())
          state.allow_together(a, near.node);
}

/// Puts on what a start has.
void activate(HiddenGraph& state, const graph::MotionGraph& start, const StartNodes& nodes) {
  for (const auto& shown : nodes)
    for (const Index i : shown) state.activate(i);
  visit_edges_and_links(
      start, nodes,
      [&](Index a, Index b) {
        if (state.can_add_edge(a, b)) state.add_edge(a, b);
      },
      [&](Index v, Index w) {
        if (state.can_link(v, w)) state.link(v, w);
      });
}

}  // namespace

std::vector<HiddenGraph> hidden_graphs(std::span<const graph::MotionGraph> starts, const Gates& gates) {
  if (starts.empty()) throw core::InputError("hidden graphs: there is no start");
  const auto& first = starts.front().sketch;
  for (const auto& start : starts)
    if (start.sketch.width != first.width || start.sketch.height != first.height ||
        start.sketch.frames.size() != first.frames.size())
      throw core::InputError("hidden graphs: the starts are of different clips");
  HiddenGraph all(first.width, first.height, static_cast<int>(first.frames.size()), gates);
  std::vector<StartNodes> nodes(starts.size());
  for (std::size_t t = 0; t < first.frames.size(); ++t) {
    std::vector<Index> known;
    for (std::size_t k = 0; k < starts.size(); ++k)
      nodes[k].push_back(add_patches(all, starts[k].sketch.frames[t], static_cast<int>(t), known, gates));
  }
  for (std::size_t k = 0; k < starts.size(); ++k) allow(all, starts[k], nodes[k]);
  std::vector<HiddenGraph> states;
  for (std::size_t k = 0; k < starts.size(); ++k) activate(states.emplace_back(all), starts[k], nodes[k]);
  return states;
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
