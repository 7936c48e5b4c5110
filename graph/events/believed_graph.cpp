// SPDX-License-Identifier: Apache-2.0
#include "graph/events/believed_graph.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "graph/curves/curve_strokes.hpp"
#include "graph/events/believed_lives.hpp"
#include "graph/events/continued_strokes.hpp"
#include "graph/events/kept_identity.hpp"
#include "graph/matching/frame_links.hpp"

namespace emberfold::graph {

namespace {

constexpr double kAnyBridge = std::numeric_limits<double>::max();  // of things
constexpr int kRounds = 5;                                         // of naming strokes anew; clips take two

/// Patches of one component of a stroke.
using Piece = std::vector<std::uint32_t>;

/// Returns the pieces of each stroke that is in several: first the one that most patches are `followed` in,
/// of equals the largest.
std::vector<std::vector<Piece>> broken_strokes(const AttributeGraph& graph,
                                               const std::vector<bool>& followed) {
  const Components parts = components(graph);
  std::map<SubgraphId, std::map<std::uint32_t, Piece>> of_stroke;
  for (std::uint32_t v = 0; v < graph.size(); ++v)
    of_stroke[graph.vertices()[v].subgraph][parts.of_vertex[v]].push_back(v);
  std::vector<std::vector<Piece>> broken;
  for (auto& [stroke, by_part] : of_stroke) {
    if (by_part.size() < 2) continue;
    std::vector<Piece> pieces;
    for (auto& [part, piece] : by_part) pieces.push_back(std::move(piece));
    std::ranges::stable_sort(pieces, std::ranges::greater{}, [&](const Piece& piece) {
      return std::pair(std::ranges::count_if(piece, [&](std::uint32_t v) { return followed[v]; }),
                       piece.size());
    });
    broken.push_back(std::move(pieces));
  }
  return broken;
}

/// The shortest bridge between two pieces.
struct Bridge {
  double length = 0;
  std::uint32_t from = 0, to = 0;
  std::size_t piece = 0;
};

/// Returns the shortest bridge from a piece to one of the others that are waiting, if it is short enough.
std::optional<Bridge> shortest_bridge(const AttributeGraph& graph, const Piece& whole,
                                      std::span<const Piece> waiting, double longest) {
  Bridge best{longest};
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

/// Joins the pieces of each stroke, those of things over any gap; what is too far away from the first goes.
AttributeGraph join_pieces(const AttributeGraph& graph, const std::set<SubgraphId>& things,
                           const std::vector<bool>& followed) {
  std::vector<Edge> edges(graph.edges().begin(), graph.edges().end());
  std::vector<bool> stays(graph.size(), true);
  for (auto& pieces : broken_strokes(graph, followed)) {
    Piece whole = std::move(pieces.front());
    pieces.erase(pieces.begin());
    const bool is_thing = things.contains(graph.vertices()[whole.front()].subgraph);
    const double longest = is_thing ? kAnyBridge : kLongestGap;
    while (const auto bridge = shortest_bridge(graph, whole, pieces, longest)) {
      const auto ends = std::minmax(graph.vertices()[bridge->from].id, graph.vertices()[bridge->to].id);
      edges.push_back({ends.first, ends.second});
      const auto joined = pieces.begin() + static_cast<std::ptrdiff_t>(bridge->piece);
      whole.insert(whole.end(), joined->begin(), joined->end());
      pieces.erase(joined);
    }
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

/// Returns which patches of a frame are linked with one of the edited frame before, of the same stroke.
std::vector<bool> followed_patches(const AttributeGraph& before, const AttributeGraph& after,
                                   std::span<const Link> links) {
  std::vector<bool> followed(after.size());
  for (const Link& link : links) {
    const std::size_t i = before.index_of(link.before), j = after.index_of(link.after);
    if (i != before.size() && j != after.size())
      followed[j] = followed[j] || before.vertices()[i].subgraph == after.vertices()[j].subgraph;
  }
  return followed;
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

/// Returns the nearest patches of two strokes that may be linked, as indices; none if the strokes are linked.
std::optional<std::pair<std::size_t, std::size_t>> nearest_patches(const AttributeGraph& before,
                                                                   const AttributeGraph& after,
                                                                   const detail::LinkPartners& partners,
                                                                   SubgraphId from, SubgraphId to) {
  const auto is_of_to = [&](std::size_t j) { return after.vertices()[j].subgraph == to; };
  double nearest = kLongestGap;
  std::optional<std::pair<std::size_t, std::size_t>> best;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before.vertices()[i].subgraph != from) continue;
    if (std::ranges::any_of(partners.successors[i], is_of_to)) return std::nullopt;
    for (std::size_t j = 0; j < after.size(); ++j) {
      if (!is_of_to(j) || !partners.admit(i, j)) continue;
      const double length = distance(before.patch(i).position, after.patch(j).position);
      if (length < nearest) nearest = length, best = {i, j};
    }
  }
  return best;
}

/// Links each stroke that an event names in the frame before with each in the frame after, where no link
/// is left: a part that grows within a frame as it splits off was not born.
void link_named_strokes(const AttributeGraph& before, const AttributeGraph& after,
                        std::span<const Event* const> events, std::vector<Link>& links) {
  detail::LinkPartners partners(detail::index_links(before, after, links));
  for (const Event* event : events)
    for (const SubgraphId from : event->before)
      for (const SubgraphId to : event->after)
        if (const auto pair = nearest_patches(before, after, partners, from, to)) {
          partners.add(pair->first, pair->second);
          links.push_back({before.vertices()[pair->first].id, after.vertices()[pair->second].id});
        }
  std::ranges::sort(links);
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

/// A motion graph whose strokes have their names, the events renamed with them, and their lives.
struct NamedStrokes {
  MotionGraph motion;
  std::vector<Event> events;
  std::map<SubgraphId, detail::Life> lives;
};

NamedStrokes name_strokes(const MotionGraph& motion, const std::vector<Event>& events,
                          std::span<const int> cuts, double believed) {
  NamedStrokes named{motion, events, {}};
  keep_identity(named.motion, named.events, believed);
  const auto of_frame = detail::believed_events(named.events, believed, motion.sketch.frames.size());
  detail::continue_strokes(named.motion, named.events, detail::believed_lives(named.motion, of_frame, cuts));
  named.lives = detail::believed_lives(named.motion, of_frame, cuts);
  return named;
}

/// Gives events the probabilities that the strokes with both ends, or with none, have.
void settle_probabilities(const MotionGraph& motion, std::vector<Event>& events, std::span<const int> cuts) {
  for (int round = 0; round < kRounds; ++round) {
    NamedStrokes named = name_strokes(motion, events, cuts, detail::kEven);
    if (!detail::settle_open_ends(named.lives, named.events)) return;
    for (std::size_t k = 0; k < events.size(); ++k) events[k].probability = named.events[k].probability;
  }
}

}  // namespace

void keep_believed(MotionGraph& motion, std::vector<Event>& events, std::span<const int> cuts,
                   double believed) {
  settle_probabilities(motion, events, cuts);
  NamedStrokes named = name_strokes(motion, events, cuts, believed);
  motion = std::move(named.motion);
  events = std::move(named.events);
  const auto of_frame = detail::believed_events(events, believed, motion.sketch.frames.size());
  std::set<SubgraphId> left_out, things;
  for (const auto& [stroke, life] : named.lives) {
    if (life.is_thing())
      things.insert(stroke);
    else if (!life.begins && !life.ends && !(life.comes_in && life.goes_out))
      left_out.insert(stroke);
  }
  auto& frames = motion.sketch.frames;
  for (std::size_t t = 0; t < frames.size(); ++t) {
    frames[t] = separate_strokes(frames[t], left_out);
    const std::vector<bool> followed = t > 0 ? followed_patches(frames[t - 1], frames[t], motion.links[t])
                                             : std::vector<bool>(frames[t].size());
    frames[t] = join_pieces(frames[t], things, followed);
    if (t == 0) continue;
    motion.links[t] = believed_links(frames[t - 1], frames[t], motion.links[t], of_frame[t]);
    link_named_strokes(frames[t - 1], frames[t], of_frame[t], motion.links[t]);
  }
  remove_absent_strokes(motion, events);
}

}  // namespace emberfold::graph
