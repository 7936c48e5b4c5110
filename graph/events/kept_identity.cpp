// SPDX-License-Identifier: Apache-2.0
#include "graph/events/kept_identity.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "graph/events/joints.hpp"
#include "graph/matching/frame_links.hpp"

namespace emberfold::graph {

namespace {

using Names = std::vector<std::uint32_t>;  // of each vertex of a frame; 0: none yet

/// Returns the names of linked patches, of several the one of the nearest.
Names linked_names(const AttributeGraph& before, const AttributeGraph& after, std::span<const Link> links,
                   const Names& names_before) {
  Names names(after.size(), 0);
  std::vector<double> nearest(after.size(), 0);
  for (const auto& [i, j] : detail::index_links(before, after, links).links) {
    const double way = distance(before.patch(i).position, after.patch(j).position);
    if (names[j] == 0 || way < nearest[j]) names[j] = names_before[i], nearest[j] = way;
  }
  return names;
}

/// Names the other patches as the nearest named ones of their components; new ones where there is none.
void spread_names(const AttributeGraph& graph, Names& names, std::uint32_t& last) {
  std::vector<std::uint32_t> named;
  for (std::uint32_t v = 0; v < names.size(); ++v)
    if (names[v] != 0) named.push_back(v);
  detail::ShortestPaths paths(graph);
  paths.search(named);
  for (const std::uint32_t v : paths.reached())
    if (names[v] == 0) names[v] = names[paths.source(v)];
  const Components parts = components(graph);
  Names of_part(parts.count, 0);
  for (std::uint32_t v = 0; v < names.size(); ++v) {
    if (names[v] != 0) continue;
    std::uint32_t& name = of_part[parts.of_vertex[v]];
    if (name == 0) name = ++last;
    names[v] = name;
  }
}

/// Returns the name that most patches have of a component that identify() calls `stroke`; 0 if there is none.
std::uint32_t usual_name(const AttributeGraph& graph, const Names& names, SubgraphId stroke) {
  std::map<std::uint32_t, std::size_t> counts;
  for (std::uint32_t v = 0; v < names.size(); ++v)
    if (graph.vertices()[v].subgraph == stroke) ++counts[names[v]];
  std::pair<std::uint32_t, std::size_t> most{0, 0};
  for (const auto& [name, count] : counts)
    if (count > most.second) most = {name, count};
  return most.first;
}

void rename(const AttributeGraph& graph, Names& names, SubgraphId stroke, std::uint32_t from,
            std::uint32_t to) {
  for (std::uint32_t v = 0; v < names.size(); ++v)
    if (graph.vertices()[v].subgraph == stroke && names[v] == from) names[v] = to;
}

/// Ends the strokes of a believed separation or union, and gives what it leaves new names. A stroke's pieces
/// elsewhere go with its first part. `became`: names that strokes of the frame before have got in this frame.
void change_names(const Event& event, const AttributeGraph& before, const AttributeGraph& after,
                  const Names& names_before, Names& names, std::uint32_t& last,
                  std::map<std::uint32_t, std::uint32_t>& became) {
  if (event.before.size() + event.after.size() != 3) return;
  const std::uint32_t first = ++last;
  if (event.after.size() == 2) {
    rename(after, names, event.after[0], usual_name(after, names, event.after[0]), first);
    rename(after, names, event.after[1], usual_name(after, names, event.after[1]), ++last);
  }
  for (const SubgraphId ended : event.before) {
    const std::uint32_t name = usual_name(before, names_before, ended);
    const auto [at, is_new] = became.try_emplace(name, name);
    const std::uint32_t now = at->second;
    std::ranges::replace(names, now, first);
    for (auto& [was, is] : became)
      if (is == now) is = first;
  }
}

std::vector<SubgraphId> renamed(const AttributeGraph& graph, const Names& names,
                                const std::vector<SubgraphId>& strokes) {
  std::vector<SubgraphId> result;
  for (const SubgraphId stroke : strokes) result.push_back({usual_name(graph, names, stroke)});
  return result;
}

}  // namespace

void keep_identity(MotionGraph& motion, std::vector<Event>& events, double believed) {
  auto& frames = motion.sketch.frames;
  std::vector<std::vector<Event*>> of_frame(frames.size());
  for (Event& event : events) of_frame.at(static_cast<std::size_t>(event.frame)).push_back(&event);
  std::uint32_t last = 0;
  AttributeGraph before;
  Names names_before;
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const AttributeGraph after = frames[t];
    Names names = linked_names(before, after, motion.links[t], names_before);
    spread_names(after, names, last);
    std::map<std::uint32_t, std::uint32_t> became;
    for (const Event* event : of_frame[t])
      if (event->probability >= believed)
        change_names(*event, before, after, names_before, names, last, became);
    for (Event* event : of_frame[t]) {
      event->before = renamed(before, names_before, event->before);
      event->after = renamed(after, names, event->after);
    }
    std::vector<SubgraphId> strokes(names.size());
    std::ranges::transform(names, strokes.begin(), [](std::uint32_t name) { return SubgraphId{name}; });
    frames[t] = after.with_subgraphs(strokes);
    before = after;
    names_before = std::move(names);
  }
}

}  // namespace emberfold::graph
