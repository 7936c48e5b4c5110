// SPDX-License-Identifier: Apache-2.0
#include "graph/events/events.hpp"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "graph/matching/frame_links.hpp"

namespace emberfold::graph {

namespace {
constexpr std::array<std::string_view, 6> kNames = {"birth", "death",   "split",
                                                    "merge", "connect", "disconnect"};
}

std::span<const EventType> all_event_types() {
  using enum EventType;
  static constexpr std::array kTypes = {birth, death, split, merge, connect, disconnect};
  return kTypes;
}

std::string_view name(EventType type) {
  return kNames[static_cast<std::size_t>(type)];
}

std::optional<EventType> event_type(std::string_view name) {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<EventType>(found - kNames.begin());
}

void sort_events(std::vector<Event>& events) {
  std::sort(events.begin(), events.end(), [](const Event& a, const Event& b) {
    return std::tie(a.frame, a.type, a.position.x, a.position.y, a.before, a.after) <
           std::tie(b.frame, b.type, b.position.x, b.position.y, b.before, b.after);
  });
}

namespace {

constexpr std::uint32_t kNone = ~std::uint32_t{0};

/// Of each vertex the one partner it goes on with, 1–1, or kNone.
using Partners = std::vector<std::uint32_t>;

Point edge_middle(const AttributeGraph& graph, std::uint32_t a, std::uint32_t b) {
  return (graph.patch(a).position + graph.patch(b).position) * 0.5;
}

std::vector<SubgraphId> distinct(SubgraphId a, SubgraphId b) {
  if (a == b) return {a};
  return {std::min(a, b), std::max(a, b)};
}

/// The edges of `graph` whose ends both go on in `other`, where no edge is between them.
std::vector<Event> edge_events(const AttributeGraph& graph, const AttributeGraph& other,
                               const Partners& partner, EventType type, int frame) {
  std::vector<Event> events;
  for (std::uint32_t a = 0; a < graph.size(); ++a) {
    if (partner[a] == kNone) continue;
    for (const std::uint32_t b : graph.neighbours(a)) {
      if (b < a || partner[b] == kNone) continue;
      const auto there = other.neighbours(partner[a]);
      if (std::binary_search(there.begin(), there.end(), partner[b])) continue;
      Event event{frame, type, edge_middle(graph, a, b), 1, {}, {}};
      const auto here = distinct(graph.vertices()[a].subgraph, graph.vertices()[b].subgraph);
      const auto elsewhere =
          distinct(other.vertices()[partner[a]].subgraph, other.vertices()[partner[b]].subgraph);
      event.before = type == EventType::connect ? elsewhere : here;
      event.after = type == EventType::connect ? here : elsewhere;
      events.push_back(std::move(event));
    }
  }
  return events;
}

/// The strokes that each vertex with several partners is linked with.
std::vector<std::vector<SubgraphId>> strokes_of_partners(const AttributeGraph& graph,
                                                         const AttributeGraph& other, const detail::Gap& gap,
                                                         bool forward) {
  std::vector<std::vector<SubgraphId>> result(graph.size());
  for (const auto& [i, j] : gap.links) {
    result[forward ? i : j].push_back(other.vertices()[forward ? j : i].subgraph);
  }
  for (auto& strokes : result) {
    std::sort(strokes.begin(), strokes.end());
    strokes.erase(std::unique(strokes.begin(), strokes.end()), strokes.end());
  }
  return result;
}

void vertex_events(const AttributeGraph& before, const AttributeGraph& after, const detail::Gap& gap,
                   int frame, std::vector<Event>& events) {
  const auto next = strokes_of_partners(before, after, gap, true);
  const auto past = strokes_of_partners(after, before, gap, false);
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (gap.successors[i] == 1) continue;
    const EventType type = gap.successors[i] == 0 ? EventType::death : EventType::split;
    const Vertex& vertex = before.vertices()[i];
    events.push_back({frame, type, vertex.patch.position, 1, {vertex.subgraph}, next[i]});
  }
  for (std::size_t j = 0; j < after.size(); ++j) {
    if (gap.predecessors[j] == 1) continue;
    const EventType type = gap.predecessors[j] == 0 ? EventType::birth : EventType::merge;
    const Vertex& vertex = after.vertices()[j];
    events.push_back({frame, type, vertex.patch.position, 1, past[j], {vertex.subgraph}});
  }
}

}  // namespace

std::vector<Event> patch_events(const MotionGraph& motion) {
  validate(motion);
  const auto& frames = motion.sketch.frames;
  std::vector<Event> events;
  for (std::size_t t = 1; t < frames.size(); ++t) {
    const AttributeGraph &before = frames[t - 1], &after = frames[t];
    const detail::Gap gap = detail::gap(before, after, motion.links[t]);
    const int frame = static_cast<int>(t);
    vertex_events(before, after, gap, frame, events);
    Partners next(before.size(), kNone), past(after.size(), kNone);
    for (const auto& [i, j] : gap.links) {
      if (gap.successors[i] == 1 && gap.predecessors[j] == 1) next[i] = j, past[j] = i;
    }
    for (auto& list : {edge_events(after, before, past, EventType::connect, frame),
                       edge_events(before, after, next, EventType::disconnect, frame)}) {
      events.insert(events.end(), list.begin(), list.end());
    }
  }
  sort_events(events);
  return events;
}

}  // namespace emberfold::graph
