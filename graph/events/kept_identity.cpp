// SPDX-License-Identifier: Apache-2.0
#include "graph/events/kept_identity.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

#include "graph/events/event_family.hpp"
#include "graph/events/joints.hpp"
#include "graph/matching/frame_links.hpp"

namespace emberfold::graph {

namespace {

constexpr double kSideReach = 20;  // px, set by hand: readings place one change up to 10 px apart

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

/// Patches of one frame, ascending.
using Patches = std::vector<std::uint32_t>;

Patches patches_of(const AttributeGraph& graph, SubgraphId stroke) {
  Patches patches;
  for (std::uint32_t v = 0; v < graph.size(); ++v)
    if (graph.vertices()[v].subgraph == stroke) patches.push_back(v);
  return patches;
}

/// Divides a component at its edge nearest to a place: patches go with the nearer end. Returns one set where
/// no edge is within reach.
std::vector<Patches> sides_of(const AttributeGraph& graph, SubgraphId stroke, Point place) {
  std::array<std::uint32_t, 2> ends{};
  double nearest = kSideReach;
  for (const Edge& edge : graph.edges()) {
    const auto a = static_cast<std::uint32_t>(graph.index_of(edge.a)),
               b = static_cast<std::uint32_t>(graph.index_of(edge.b));
    if (graph.vertices()[a].subgraph != stroke) continue;
    const double away = distance((graph.patch(a).position + graph.patch(b).position) * 0.5, place);
    if (away < nearest) nearest = away, ends = {a, b};
  }
  if (nearest >= kSideReach) return {patches_of(graph, stroke)};
  detail::ShortestPaths paths(graph);
  paths.search(ends);
  std::vector<Patches> sides(2);
  for (const std::uint32_t v : patches_of(graph, stroke))
    sides[paths.source(v) == ends[0] ? 0 : 1].push_back(v);
  return sides;
}

/// The patches that an event is about, by stroke.
struct ChangedPatches {
  std::vector<Patches> before, after;
};

/// Finds the patches of an event's strokes. Where the two strokes of a union or separation are one component,
/// as only another reading of the clip shows them apart, they are its two sides.
ChangedPatches changed_patches(const Event& event, const AttributeGraph& before,
                               const AttributeGraph& after) {
  const auto sets = [&](const AttributeGraph& graph, const std::vector<SubgraphId>& strokes, bool two) {
    if (two && strokes.size() == 1) return sides_of(graph, strokes[0], event.position);
    std::vector<Patches> result;
    for (const SubgraphId stroke : strokes) result.push_back(patches_of(graph, stroke));
    return result;
  };
  const auto family = detail::family(event.type);
  return {sets(before, event.before, family == detail::Family::unite),
          sets(after, event.after, family == detail::Family::separate)};
}

/// Returns the name that most of some patches have; 0 of none.
std::uint32_t usual_name(const Names& names, const Patches& patches) {
  std::map<std::uint32_t, std::size_t> counts;
  for (const std::uint32_t v : patches) ++counts[names[v]];
  std::pair<std::uint32_t, std::size_t> most{0, 0};
  for (const auto& [name, count] : counts)
    if (count > most.second) most = {name, count};
  return most.first;
}

void rename(Names& names, const Patches& patches, std::uint32_t from, std::uint32_t to) {
  for (const std::uint32_t v : patches)
    if (names[v] == from) names[v] = to;
}

/// Ends the strokes of a believed separation or union, and gives what it leaves new names. A stroke's pieces
/// elsewhere go with its first part. `became`: names that strokes of the frame before have got in this frame.
void change_names(const ChangedPatches& change, const Names& names_before, Names& names, std::uint32_t& last,
                  std::map<std::uint32_t, std::uint32_t>& became) {
  if (change.before.size() + change.after.size() != 3) return;
  const std::uint32_t first = ++last;
  if (change.after.size() == 2) {
    rename(names, change.after[0], usual_name(names, change.after[0]), first);
    rename(names, change.after[1], usual_name(names, change.after[1]), ++last);
  }
  for (const Patches& ended : change.before) {
    const std::uint32_t name = usual_name(names_before, ended);
    const auto [at, is_new] = became.try_emplace(name, name);
    const std::uint32_t now = at->second;
    std::ranges::replace(names, now, first);
    for (auto& [was, is] : became)
      if (is == now) is = first;
  }
}

/// Returns the names of some sets of patches, each once, in their order.
std::vector<SubgraphId> names_of(const Names& names, const std::vector<Patches>& sets) {
  std::vector<SubgraphId> result;
  for (const Patches& patches : sets)
    if (const SubgraphId name{usual_name(names, patches)}; std::ranges::find(result, name) == result.end())
      result.push_back(name);
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
    std::vector<ChangedPatches> changes;
    for (const Event* event : of_frame[t]) {
      changes.push_back(changed_patches(*event, before, after));
      if (event->probability >= believed) change_names(changes.back(), names_before, names, last, became);
    }
    for (std::size_t k = 0; k < changes.size(); ++k) {
      of_frame[t][k]->before = names_of(names_before, changes[k].before);
      of_frame[t][k]->after = names_of(names, changes[k].after);
    }
    std::vector<SubgraphId> strokes(names.size());
    std::ranges::transform(names, strokes.begin(), [](std::uint32_t name) { return SubgraphId{name}; });
    frames[t] = after.with_subgraphs(strokes);
    before = after;
    names_before = std::move(names);
  }
}

}  // namespace emberfold::graph
