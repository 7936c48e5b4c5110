// SPDX-License-Identifier: Apache-2.0
#include "graph/events/believed_graph.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "graph/curves/curve_strokes.hpp"
#include "graph/events/believed_lives.hpp"
#include "graph/events/continued_strokes.hpp"
#include "graph/events/kept_identity.hpp"

namespace emberfold::graph {

namespace {

constexpr double kLongestBridge = 30;  // px; wider gaps are read as one stroke by mistake

/// Patches of one component of a stroke.
using Piece = std::vector<std::uint32_t>;

/// Returns the pieces of each stroke that is in several, the largest first.
std::vector<std::vector<Piece>> broken_strokes(const AttributeGraph& graph) {
  const Components parts = components(graph);
  std::map<SubgraphId, std::map<std::uint32_t, Piece>> of_stroke;
  for (std::uint32_t v = 0; v < graph.size(); ++v)
    of_stroke[graph.vertices()[v].subgraph][parts.of_vertex[v]].push_back(v);
  std::vector<std::vector<Piece>> broken;
  for (auto& [stroke, by_part] : of_stroke) {
    if (by_part.size() < 2) continue;
    std::vector<Piece> pieces;
    for (auto& [part, piece] : by_part) pieces.push_back(std::move(piece));
    std::ranges::stable_sort(pieces, std::ranges::greater{}, &Piece::size);
    broken.push_back(std::move(pieces));
  }
  return broken;
}

/// The shortest bridge between two pieces.
struct Bridge {
  double length = kLongestBridge;
  std::uint32_t from = 0, to = 0;
  std::size_t piece = 0;
};

/// Returns the shortest bridge from a piece to one of the others that are waiting, if it is short enough.
std::optional<Bridge> shortest_bridge(const AttributeGraph& graph, const Piece& whole,
                                      std::span<const Piece> waiting) {
  Bridge best;
  bool found = false;
  for (std::size_t k = 0; k < waiting.size(); ++k)
    for (const std::uint32_t v : whole)
      for (const std::uint32_t w : waiting[k]) {
        const double length = distance(graph.patch(v).position, graph.patch(w).position);
        if (length > best.length || (found && length == best.length)) continue;
        best = {length, v, w, k};
        found = true;
      }
  return found ? std::optional(best) : std::nullopt;
}

/// Joins the pieces of each stroke; of what is too far away from the largest, things stay and the rest goes.
AttributeGraph join_pieces(const AttributeGraph& graph, const std::set<SubgraphId>& things) {
  std::vector<Edge> edges(graph.edges().begin(), graph.edges().end());
  std::vector<bool> stays(graph.size(), true);
  for (auto& pieces : broken_strokes(graph)) {
    Piece whole = std::move(pieces.front());
    pieces.erase(pieces.begin());
    while (const auto bridge = shortest_bridge(graph, whole, pieces)) {
      const auto ends = std::minmax(graph.vertices()[bridge->from].id, graph.vertices()[bridge->to].id);
      edges.push_back({ends.first, ends.second});
      const auto joined = pieces.begin() + static_cast<std::ptrdiff_t>(bridge->piece);
      whole.insert(whole.end(), joined->begin(), joined->end());
      pieces.erase(joined);
    }
    if (things.contains(graph.vertices()[whole.front()].subgraph)) continue;
    for (const Piece& piece : pieces)
      for (const std::uint32_t v : piece) stays[v] = false;
  }
  const std::span<const Vertex> vertices = graph.vertices();
  return induced_subgraph(
      AttributeGraph({vertices.begin(), vertices.end()}, std::move(edges), graph.memory()), stays);
}

/// Returns a graph without the strokes that are left out, and without edges between two strokes.
AttributeGraph separate_strokes(const AttributeGraph& graph, const std::set<SubgraphId>& left_out) {
  std::vector<bool> stays(graph.size());
  for (std::uint32_t v = 0; v < graph.size(); ++v)
    stays[v] = !left_out.contains(graph.vertices()[v].subgraph);
  return without_touches(induced_subgraph(graph, stays));
}

/// Returns the links that stay between two edited frames.
std::vector<Link> believed_links(const AttributeGraph& before, const AttributeGraph& after,
                                 std::span<const Link> links, std::span<const Event* const> events) {
  std::vector<Link> kept;
  for (const Link& link : links) {
    const std::size_t i = before.index_of(link.before), j = after.index_of(link.after);
    if (i == before.size() || j == after.size()) continue;
    const SubgraphId from = before.vertices()[i].subgraph, to = after.vertices()[j].subgraph;
    if (from == to || std::ranges::any_of(events, [&](const Event* event) {
          return detail::names(event->before, from) && detail::names(event->after, to);
        }))
      kept.push_back(link);
  }
  return kept;
}

/// Takes the strokes that are left out from the events.
void remove_absent_strokes(const MotionGraph& motion, std::vector<Event>& events) {
  std::vector<std::set<SubgraphId>> there(motion.sketch.frames.size());
  for (std::size_t t = 0; t < there.size(); ++t)
    for (const Vertex& vertex : motion.sketch.frames[t].vertices()) there[t].insert(vertex.subgraph);
  for (Event& event : events) {
    const auto t = static_cast<std::size_t>(event.frame);
    std::erase_if(event.before, [&](SubgraphId stroke) { return !there[t - 1].contains(stroke); });
    std::erase_if(event.after, [&](SubgraphId stroke) { return !there[t].contains(stroke); });
  }
}

}  // namespace

void keep_believed(MotionGraph& motion, std::vector<Event>& events, std::span<const int> cuts,
                   double believed) {
  keep_identity(motion, events, believed);
  auto& frames = motion.sketch.frames;
  const auto of_frame = detail::believed_events(events, believed, frames.size());
  detail::continue_strokes(motion, events, detail::believed_lives(motion, of_frame, cuts));
  std::set<SubgraphId> left_out, things;
  for (const auto& [stroke, life] : detail::believed_lives(motion, of_frame, cuts)) {
    if (life.is_thing())
      things.insert(stroke);
    else if (!life.begins && !life.ends && !(life.comes_in && life.goes_out))
      left_out.insert(stroke);
  }
  for (std::size_t t = 0; t < frames.size(); ++t) {
    frames[t] = join_pieces(separate_strokes(frames[t], left_out), things);
    if (t > 0) motion.links[t] = believed_links(frames[t - 1], frames[t], motion.links[t], of_frame[t]);
  }
  remove_absent_strokes(motion, events);
}

}  // namespace emberfold::graph
