// SPDX-License-Identifier: Apache-2.0
#include "sketch/refinement/editable_graph.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "core/error.hpp"
#include "sketch/patches/patch_types.hpp"

namespace emberfold::sketch {

namespace {

template <class Value>
bool has(const std::vector<Value>& values, const Value& value) {
  return std::find(values.begin(), values.end(), value) != values.end();
}

void insert(std::vector<Slot>& slots, Slot slot) {
  slots.insert(std::lower_bound(slots.begin(), slots.end(), slot), slot);
}

/// Leaves no empty slots at the end, so that what is undone is as before.
template <class Patches, class Neighbours>
void trim(Patches& patches, Neighbours& neighbours) {
  while (!patches.empty() && !patches.back()) {
    patches.pop_back();
    neighbours.pop_back();
  }
}

[[noreturn]] void refuse(const std::string& what, Slot slot) {
  throw core::InputError("sketch edit: " + what + " at slot " + std::to_string(slot));
}

}  // namespace

double degree_cost(std::size_t degree) {
  constexpr std::array<double, 5> kNats = {1, 3, 0, 1, 2};
  return kNats[std::min<std::size_t>(degree, 4)];
}

EditableGraph::EditableGraph(const graph::AttributeGraph& graph) : neighbours_(graph.size()) {
  for (std::size_t i = 0; i < graph.size(); ++i) {
    patches_.emplace_back(graph.patch(i));
    neighbours_[i].assign(graph.neighbours(i).begin(), graph.neighbours(i).end());
  }
}

double EditableGraph::length() const {
  double nats = 0;
  for (Slot slot = 0; slot < slots(); ++slot)
    if (holds(slot)) nats += degree_cost(degree(slot)) - worth(patch(slot));
  return nats;
}

double EditableGraph::change(const GraphEdit& edit) const {
  std::vector<std::pair<Slot, int>> turns;  // what becomes of degrees; ascending
  turns.reserve(2 * (edit.remove_edges.size() + edit.add_edges.size()));
  for (const auto& [a, b] : edit.remove_edges) turns.insert(turns.end(), {{a, -1}, {b, -1}});
  for (const auto& [a, b] : edit.add_edges) turns.insert(turns.end(), {{a, 1}, {b, 1}});
  std::sort(turns.begin(), turns.end());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    if (kept > 0 && turns[kept - 1].first == turns[i].first)
      turns[kept - 1].second += turns[i].second;
    else
      turns[kept++] = turns[i];
  }
  turns.resize(kept);
  std::vector<char> done(kept, 0);
  const auto find = [&](Slot slot) {
    const auto at = std::ranges::lower_bound(turns, slot, {}, &std::pair<Slot, int>::first);
    return at != turns.end() && at->first == slot ? static_cast<std::size_t>(at - turns.begin()) : kept;
  };
  double nats = 0;
  for (const Slot slot : edit.remove_patches) {
    nats -= degree_cost(degree(slot)) - worth(patch(slot));
    if (const std::size_t turn = find(slot); turn < kept) done[turn] = 1;
  }
  for (const auto& [slot, patch] : edit.add_patches) {
    const std::size_t turn = find(slot);
    const bool turns_here = turn < kept && done[turn] == 0;
    nats += degree_cost(turns_here ? static_cast<std::size_t>(turns[turn].second) : 0) - worth(patch);
    if (turns_here) done[turn] = 1;
  }
  for (std::size_t i = 0; i < kept; ++i)
    if (const auto& [slot, turn] = turns[i]; done[i] == 0)
      nats += degree_cost(static_cast<std::size_t>(static_cast<std::ptrdiff_t>(degree(slot)) + turn)) -
              degree_cost(degree(slot));
  return nats;
}

void EditableGraph::check(const GraphEdit& edit) const {
  for (const auto& [a, b] : edit.remove_edges)
    if (!(a < b && holds(a) && holds(b) && has(neighbours_[a], b)))
      refuse("cuts an edge that is not there", a);
  for (const Slot slot : edit.remove_patches) {
    if (!holds(slot)) refuse("removes a patch that is not there", slot);
    for (const Slot other : neighbours_[slot])
      if (!has(edit.remove_edges, sketch::make_edge(slot, other)))
        refuse("removes a patch but not its edge", slot);
  }
  std::vector<Slot> added;
  for (const auto& [slot, patch] : edit.add_patches) {
    if ((holds(slot) && !has(edit.remove_patches, slot)) || has(added, slot))
      refuse("adds a patch over another", slot);
    added.push_back(slot);
  }
  const auto there = [&](Slot slot) {
    return has(added, slot) || (holds(slot) && !has(edit.remove_patches, slot));
  };
  for (const auto& [a, b] : edit.add_edges)
    if (!(a < b && there(a) && there(b)) ||
        (holds(a) && has(neighbours_[a], b) && !has(edit.remove_edges, {a, b})))
      refuse("ties what cannot be tied", a);
}

GraphEdit EditableGraph::apply(const GraphEdit& edit) {
  check(edit);
  GraphEdit reverse;
  reverse.remove_edges = edit.add_edges;
  reverse.add_edges = edit.remove_edges;
  for (const auto& [a, b] : edit.remove_edges) {
    std::erase(neighbours_[a], b);
    std::erase(neighbours_[b], a);
  }
  for (const Slot slot : edit.remove_patches) {
    reverse.add_patches.emplace_back(slot, *patches_[slot]);
    patches_[slot].reset();
  }
  for (const auto& [slot, patch] : edit.add_patches) {
    if (slot >= slots()) {
      patches_.resize(slot + 1);
      neighbours_.resize(slot + 1);
    }
    patches_[slot] = patch;
    reverse.remove_patches.push_back(slot);
  }
  for (const auto& [a, b] : edit.add_edges) {
    insert(neighbours_[a], b);
    insert(neighbours_[b], a);
  }
  trim(patches_, neighbours_);
  return reverse;
}

graph::AttributeGraph EditableGraph::graph() const {
  std::vector<graph::VertexId> ids(slots());
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (Slot slot = 0; slot < slots(); ++slot) {
    if (!holds(slot)) continue;
    ids[slot] = {static_cast<std::uint32_t>(vertices.size())};
    vertices.push_back({ids[slot], {}, patch(slot)});
    for (const Slot other : neighbours(slot))
      if (other < slot) edges.push_back({ids[other], ids[slot]});
  }
  return name_patch_types(std::move(vertices), std::move(edges));
}

bool EditableGraph::operator==(const EditableGraph& other) const {
  return patches_ == other.patches_ && neighbours_ == other.neighbours_;
}

void remove_patch(GraphEdit& edit, const EditableGraph& draft, Slot slot) {
  for (const Slot other : draft.neighbours(slot))
    if (const SlotEdge edge = make_edge(slot, other); !has(edit.remove_edges, edge))
      edit.remove_edges.push_back(edge);
  edit.remove_patches.push_back(slot);
}

}  // namespace emberfold::sketch
