// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

/// The number of a patch in an EditableGraph; it stays the same as long as the graph lives.
using Slot = std::uint32_t;
using SlotEdge = std::pair<Slot, Slot>;  ///< an edge, the smaller slot first

/// Holds a change of a sketch: patches and edges to remove, and to add (into empty slots). The edges of a
/// removed patch are listed too.
struct GraphEdit {
  std::vector<SlotEdge> remove_edges;
  std::vector<Slot> remove_patches;
  std::vector<std::pair<Slot, graph::Patch>> add_patches;
  std::vector<SlotEdge> add_edges;
};

/// Returns the nats that a vertex costs by its degree (0, 1, 2, 3, 4 and more).
/// They are relative to degree 2, after Guo, Zhu & Wu 2007: free ends cost most, so that curves close and
/// meet unless the frame contradicts it.
double degree_cost(std::size_t degree);

/// Returns the nats that a patch is worth: its coding gain, or, where that is less, the evidence that there
/// is a line: faint patches in a row may have that where each alone does not pay. Evidence does not help a
/// patch whose drawing makes the frame much worse: that is not where the line is.
inline double worth(const graph::Patch& patch) {
  constexpr double kMostOfEvidence = 3;  // nats: keeps what is there, does not outvote what codes better
  constexpr double kMostLoss = 25;       // nats
  const bool believed = patch.evidence > 0 && patch.gain > -kMostLoss;
  return believed ? std::max(patch.gain, std::min(patch.evidence, kMostOfEvidence)) : patch.gain;
}

/// Holds a sketch that is being edited, and computes the length of its frame's code:
///   length = Σ over patches of (degree_cost − worth), nats, 0 without patches.
class EditableGraph {
 public:
  /// Takes a graph whose patches carry their gain. Slots are the vertices' indices.
  explicit EditableGraph(const graph::AttributeGraph& graph);

  [[nodiscard]] Slot slots() const { return static_cast<Slot>(patches_.size()); }  ///< the next one is free
  [[nodiscard]] bool holds(Slot slot) const { return slot < slots() && patches_[slot].has_value(); }
  [[nodiscard]] const graph::Patch& patch(Slot slot) const { return *patches_[slot]; }
  [[nodiscard]] std::span<const Slot> neighbours(Slot slot) const { return neighbours_[slot]; }
  [[nodiscard]] std::size_t degree(Slot slot) const { return neighbours_[slot].size(); }

  /// Returns the length, computed anew. O(patches).
  [[nodiscard]] double length() const;
  /// Returns by how much an edit would change the length. O(edit).
  [[nodiscard]] double change(const GraphEdit& edit) const;
  /// Applies an edit and returns the edit that undoes it. Throws core::InputError (nothing is changed) for an
  /// edit that does not fit: an edge removed that is not there or added that is, a patch removed with edges
  /// left or added over another.
  GraphEdit apply(const GraphEdit& edit);

  /// Returns the graph: vertices in the order of their slots, numbered from 0, their types named anew.
  [[nodiscard]] graph::AttributeGraph graph() const;

  bool operator==(const EditableGraph&) const;

 private:
  void check(const GraphEdit& edit) const;

  std::vector<std::optional<graph::Patch>> patches_;
  std::vector<std::vector<Slot>> neighbours_;  // ascending
};

/// Returns the edge between two slots, the smaller one first.
inline SlotEdge make_edge(Slot a, Slot b) {
  return {a < b ? a : b, a < b ? b : a};
}
/// Adds to the edit the removal of a patch and of all its edges that are not removed already.
void remove_patch(GraphEdit& edit, const EditableGraph& draft, Slot slot);

}  // namespace emberfold::sketch
