// SPDX-License-Identifier: Apache-2.0
#include "graph/events/kept_identity.hpp"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

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

/// Patches of one frame, ascending.
using Patches = std::vector<std::uint32_t>;

/// The patches that an event is about, by stroke.
struct ChangedPatches {
  std::vector<Patches> before, after;
};

ChangedPatches changed_patches(const Event& event, const AttributeGraph& before,
                               const AttributeGraph& after) {
  const auto sets = [](const AttributeGraph& graph, const std::vector<SubgraphId>& strokes) {
    std::vector<Patches> result;
    for (const SubgraphId stroke : strokes) result.push_back(vertices_of(graph, stroke));
    return result;
  };
  return {sets(before, event.before), sets(after, event.after)};
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

/// Names the patches of all frames.
class Naming {
 public:
  explicit Naming(const MotionGraph& motion) : motion_(motion), names_(motion.sketch.frames.size()) {}

  /// Names the next frame.
  void add_frame(const std::vector<Event*>& events, double believed) {
    const std::size_t t = named_++;
    const AttributeGraph &before = t > 0 ? motion_.sketch.frames[t - 1] : none_,
                         &after = motion_.sketch.frames[t];
    const Names& names_before = t > 0 ? names_[t - 1] : no_names_;
    Names& names = names_[t];
    names = linked_names(before, after, motion_.links[t], names_before);
    spread_names(after, names, last_);
    std::map<std::uint32_t, std::uint32_t> became;
    for (const Event* event : events) {
      if (event->probability < believed) continue;
      const ChangedPatches change = changed_patches(*event, before, after);
      if (t > 0 && change.before.size() == 2) part_before(t - 1, change.before);
      change_names(change, names_before, names, last_, became);
    }
  }
  /// Renames the strokes of an event, once all frames have their names.
  void rename_strokes(Event& event) const {
    const auto t = static_cast<std::size_t>(event.frame);
    const ChangedPatches change =
        changed_patches(event, motion_.sketch.frames[t - 1], motion_.sketch.frames[t]);
    event.before = names_of(names_[t - 1], change.before);
    event.after = names_of(names_[t], change.after);
  }
  [[nodiscard]] const Names& names(std::size_t t) const { return names_[t]; }

 private:
  /// Gives the second of two parts with one name a name of its own, back to where they were one component or
  /// the stroke began: a believed union is of two strokes.
  void part_before(std::size_t t, const std::vector<Patches>& parts) {
    const std::uint32_t name = usual_name(names_[t], parts[0]);
    if (usual_name(names_[t], parts[1]) != name) return;
    const std::uint32_t own = ++last_;
    const bool are_apart = !is_one_component(t, parts[0], parts[1]);
    for (Patches part = parts[1];; --t) {
      std::erase_if(part, [&](std::uint32_t v) { return names_[t][v] != name; });
      Patches rest;
      for (std::uint32_t v = 0; v < names_[t].size(); ++v)
        if (names_[t][v] == name && !std::ranges::binary_search(part, v)) rest.push_back(v);
      if (part.empty() || rest.empty() || (are_apart && is_one_component(t, rest, part))) return;
      rename(names_[t], part, name, own);
      if (t == 0) return;
      part = linked_before(t, part);
    }
  }
  /// Returns whether a component holds patches of both.
  [[nodiscard]] bool is_one_component(std::size_t t, const Patches& a, const Patches& b) const {
    const Components parts = components(motion_.sketch.frames[t]);
    return std::ranges::any_of(a, [&](std::uint32_t v) {
      return std::ranges::any_of(b,
                                 [&](std::uint32_t w) { return parts.of_vertex[v] == parts.of_vertex[w]; });
    });
  }
  /// Returns the patches of the frame before that some patches are linked with.
  [[nodiscard]] Patches linked_before(std::size_t t, const Patches& patches) const {
    Patches result;
    const auto& frames = motion_.sketch.frames;
    for (const auto& [i, j] : detail::index_links(frames[t - 1], frames[t], motion_.links[t]).links)
      if (std::ranges::binary_search(patches, j)) result.push_back(i);
    std::ranges::sort(result);
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  }

  const MotionGraph& motion_;
  AttributeGraph none_;
  std::vector<Names> names_;
  Names no_names_;
  std::size_t named_ = 0;  ///< frames
  std::uint32_t last_ = 0;
};

}  // namespace

void keep_identity(MotionGraph& motion, std::vector<Event>& events, double believed) {
  auto& frames = motion.sketch.frames;
  std::vector<std::vector<Event*>> of_frame(frames.size());
  for (Event& event : events) of_frame.at(static_cast<std::size_t>(event.frame)).push_back(&event);
  Naming naming(motion);
  for (const auto& of_one : of_frame) naming.add_frame(of_one, believed);
  for (Event& event : events) naming.rename_strokes(event);
  for (std::size_t t = 0; t < frames.size(); ++t) {
    std::vector<SubgraphId> strokes;
    for (const std::uint32_t name : naming.names(t)) strokes.push_back({name});
    frames[t] = frames[t].with_subgraphs(strokes);
  }
}

}  // namespace emberfold::graph
