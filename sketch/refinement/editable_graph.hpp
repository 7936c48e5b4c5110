// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

/// Names a patch of a EditableGraph as long as the draft lives.
using Slot = std::uint32_t;
using SlotEdge = std::pair<Slot, Slot>;  ///< an edge, the smaller slot first

/// A change of a sketch: what goes (a patch's edges have to be listed too) and what comes (into empty slots).
struct GraphEdit {
  std::vector<SlotEdge> remove_edges;
  std::vector<Slot> remove_patches;
  std::vector<std::pair<Slot, graph::Patch>> add_patches;
  std::vector<SlotEdge> add_edges;
};

/// Nats that a vertex costs because of its degree (0, 1, 2, 3, 4 and more), beside one inside a curve. After
/// Guo, Zhu & Wu 2007: free ends are the dearest, so that curves close and meet where the frame does not
/// speak against it.
double degree_cost(std::size_t degree);

/// A sketch that is being edited, and how long its frame's code is with it,
///   length = Σ over patches of (degree_cost − gain), nats, 0 without patches.
class EditableGraph {
 public:
  /// Patches carry their gain. Slots are the vertices' indices.
  explicit EditableGraph(const graph::AttributeGraph& graph);

  [[nodiscard]] Slot slots() const { return static_cast<Slot>(patches_.size()); }  ///< the next one is free
  [[nodiscard]] bool holds(Slot slot) const { return slot < slots() && patches_[slot].has_value(); }
  [[nodiscard]] const graph::Patch& patch(Slot slot) const { return *patches_[slot]; }
  [[nodiscard]] std::span<const Slot> neighbours(Slot slot) const { return neighbours_[slot]; }
  [[nodiscard]] std::size_t degree(Slot slot) const { return neighbours_[slot].size(); }

  /// The length, counted anew. O(patches).
  [[nodiscard]] double length() const;
  /// By how much an edit would change it. O(edit).
  [[nodiscard]] double change(const GraphEdit& edit) const;
  /// Does it. Gives what undoes it: applied, all is as before. core::InputError (nothing done) for an edit
  /// that does not fit: an edge cut that is not there or tied that is, a patch removed with edges left or
  /// added over another.
  GraphEdit apply(const GraphEdit& edit);

  /// Vertices in the order of their slots, numbered from 0, named by their degree.
  [[nodiscard]] graph::AttributeGraph graph() const;

  bool operator==(const EditableGraph&) const;

 private:
  void check(const GraphEdit& edit) const;

  std::vector<std::optional<graph::Patch>> patches_;
  std::vector<std::vector<Slot>> neighbours_;  // ascending
};

inline SlotEdge make_edge(Slot a, Slot b) {
  return {a < b ? a : b, a < b ? b : a};
}
/// Adds to the edit that this patch goes, with all its edges that are not cut already.
void remove_patch(GraphEdit& edit, const EditableGraph& draft, Slot slot);

}  // namespace emberfold::sketch
