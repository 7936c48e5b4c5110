// SPDX-License-Identifier: Apache-2.0
#include "graph/events/part_events.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "graph/events/event_family.hpp"
#include "graph/events/joints.hpp"

namespace emberfold::graph {

namespace {

constexpr double kLeastLength = 20;  // px of a part: four patches; gaps that close are shorter
constexpr int kOwnFrames = 4;        // around a birth or death, in which all parts are of that one
constexpr double kOfPart = 0.5;      // that joins two strokes: such a part is a joint

using detail::Family;

/// A part that appears in its frame, or vanishes after it.
struct Part {
  TracedEvent event;
  std::set<VertexId> vertices;
};

double length_of(const AttributeGraph& graph, std::span<const std::uint32_t> path) {
  double length = 0;
  for (std::size_t i = 1; i < path.size(); ++i)
    length += distance(graph.patch(path[i - 1]).position, graph.patch(path[i]).position);
  return length;
}

/// Returns the vertices of strokes that go on which have no links, and the edges between these.
AttributeGraph without_links(const AttributeGraph& graph, const std::vector<bool>& is_linked) {
  const Components parts = components(graph);
  std::vector<bool> goes_on(parts.count, false);
  for (std::size_t v = 0; v < graph.size(); ++v)
    if (is_linked[v]) goes_on[parts.of_vertex[v]] = true;
  const auto is_in = [&](std::size_t v) { return !is_linked[v] && goes_on[parts.of_vertex[v]]; };
  std::vector<Vertex> vertices;
  std::vector<Edge> edges;
  for (std::size_t v = 0; v < graph.size(); ++v)
    if (is_in(v)) vertices.push_back(graph.vertices()[v]);
  for (const Edge& edge : graph.edges())
    if (is_in(graph.index_of(edge.a)) && is_in(graph.index_of(edge.b))) edges.push_back(edge);
  return {std::move(vertices), std::move(edges)};
}

/// Finds the long parts of a frame's strokes that have no links to the frame before (after, if they vanish).
std::vector<Part> find_parts(const AttributeGraph& graph, const std::vector<bool>& is_linked, bool appears,
                             int frame) {
  const AttributeGraph loose = without_links(graph, is_linked);
  const Components parts = components(loose);
  std::vector<std::vector<std::uint32_t>> members(parts.count);
  for (std::uint32_t v = 0; v < loose.size(); ++v) members[parts.of_vertex[v]].push_back(v);
  detail::ShortestPaths paths(loose);
  std::vector<Part> found;
  for (const auto& of_part : members) {
    const auto path = detail::longest_path(paths, of_part.front());
    if (length_of(loose, path) < kLeastLength) continue;
    Part part;
    part.event.event.frame = frame;
    part.event.event.type = appears ? EventType::birth : EventType::death;
    part.event.event.position = detail::path_middle(loose, path);
    auto& strokes = appears ? part.event.event.after : part.event.event.before;
    strokes.push_back(loose.vertices()[path.front()].subgraph);
    part.event.path_frame = appears ? frame : frame - 1;
    for (const std::uint32_t v : path) part.event.path.push_back(loose.vertices()[v].id);
    for (const std::uint32_t v : of_part) part.vertices.insert(loose.vertices()[v].id);
    found.push_back(std::move(part));
  }
  return found;
}

std::vector<Part> find_all_parts(const MotionGraph& motion) {
  const auto& frames = motion.sketch.frames;
  std::vector<Part> all;
  for (std::size_t t = 1; t < frames.size(); ++t) {
    const AttributeGraph &before = frames[t - 1], &after = frames[t];
    std::vector<bool> goes_on(before.size(), false), was_there(after.size(), false);
    for (const Link& link : motion.links[t])
      goes_on[before.index_of(link.before)] = was_there[after.index_of(link.after)] = true;
    for (const bool appears : {true, false})
      std::ranges::move(
          find_parts(appears ? after : before, appears ? was_there : goes_on, appears, static_cast<int>(t)),
          std::back_inserter(all));
  }
  return all;
}

/// The frames in which each stroke is born, or dies.
using Lives = std::map<std::pair<SubgraphId, EventType>, std::vector<int>>;

bool is_of_birth_or_death(const Event& part, const Lives& lives) {
  const SubgraphId stroke = part.type == EventType::birth ? part.after[0] : part.before[0];
  const auto found = lives.find({stroke, part.type});
  return found != lives.end() && std::ranges::any_of(found->second, [&](int frame) {
           return std::abs(frame - part.frame) <= kOwnFrames;
         });
}

/// Returns whether a part joins two strokes (parts them, if it vanishes).
bool is_joint(const Part& part, const TracedEvent& joint) {
  const Family joined = part.event.event.type == EventType::birth ? Family::unite : Family::separate;
  if (detail::family(joint.event.type) != joined) return false;
  const auto shared =
      std::ranges::count_if(joint.path, [&](VertexId id) { return part.vertices.contains(id); });
  return static_cast<double>(shared) >= kOfPart * static_cast<double>(part.event.path.size());
}

}  // namespace

std::vector<TracedEvent> trace_seen_events(const MotionGraph& motion) {
  std::vector<TracedEvent> events = trace_stroke_events(motion);
  Lives lives;
  for (const TracedEvent& one : events) {
    if (one.event.type == EventType::birth)
      lives[{one.event.after[0], EventType::birth}].push_back(one.event.frame);
    if (one.event.type == EventType::death)
      lives[{one.event.before[0], EventType::death}].push_back(one.event.frame);
  }
  std::vector<Part> parts = find_all_parts(motion);
  std::erase_if(parts, [&](const Part& part) { return is_of_birth_or_death(part.event.event, lives); });
  std::map<int, std::vector<const TracedEvent*>> of_frame;
  for (const TracedEvent& one : events) of_frame[one.event.frame].push_back(&one);
  std::erase_if(parts, [&](const Part& part) {
    const auto found = of_frame.find(part.event.event.frame);
    return found != of_frame.end() &&
           std::ranges::any_of(found->second, [&](const TracedEvent* one) { return is_joint(part, *one); });
  });
  for (Part& part : parts) events.push_back(std::move(part.event));
  std::ranges::stable_sort(events, [](const auto& a, const auto& b) { return precedes(a.event, b.event); });
  return events;
}

}  // namespace emberfold::graph
