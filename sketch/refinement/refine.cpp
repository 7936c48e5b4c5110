// SPDX-License-Identifier: Apache-2.0
#include "sketch/refinement/refine.hpp"

#include <algorithm>
#include <vector>

#include "sketch/refinement/editable_graph.hpp"
#include "sketch/refinement/proposals.hpp"

namespace emberfold::sketch {

namespace {

constexpr int kMostRounds = 4;

graph::AttributeGraph judged(const graph::AttributeGraph& graph, std::span<const CodingContext> axes) {
  std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  for (graph::Vertex& vertex : vertices) {
    const Coding told = best_coding(axes, vertex.patch);
    vertex.patch.cost = told.cost;
    vertex.patch.gain = told.gain;
  }
  return {std::move(vertices), {graph.edges().begin(), graph.edges().end()}};
}

/// New patches were numbered as if each edit were the only one.
GraphEdit renumbered(GraphEdit edit, Slot first, Slot now) {
  const auto shift = [&](Slot& slot) {
    if (slot >= first) slot += now - first;
  };
  for (auto& added : edit.add_patches) shift(added.first);
  for (SlotEdge& both : edit.add_edges) shift(both.first), shift(both.second);
  return edit;
}

/// Applies the edits that shorten the code most and do not meet. Returns whether there were any.
bool apply_best(EditableGraph& draft, std::vector<Proposal> proposals) {
  std::stable_sort(proposals.begin(), proposals.end(),
                   [](const Proposal& a, const Proposal& b) { return a.change < b.change; });
  const Slot first = draft.slots();
  std::vector<char> busy(first, 0);
  Slot next = first;
  std::vector<graph::Patch> fresh;  // of this round
  bool any = false;
  for (Proposal& proposal : proposals) {
    const auto taken = [&](Slot slot) { return busy[slot] != 0; };
    if (std::ranges::any_of(proposal.concerns, taken)) continue;
    std::vector<Slot> place = proposal.concerns;
    for (const Slot slot : proposal.concerns)
      place.insert(place.end(), draft.neighbours(slot).begin(), draft.neighbours(slot).end());
    std::erase_if(place, [&](Slot slot) { return slot >= first; });
    if (std::ranges::any_of(place, taken)) continue;
    const auto in_the_way = [&](const auto& added) {
      return std::ranges::any_of(
          fresh, [&](const graph::Patch& other) { return patches_overlap(added.second, other); });
    };
    if (std::ranges::any_of(proposal.edit.add_patches, in_the_way)) continue;
    for (const auto& added : proposal.edit.add_patches) fresh.push_back(added.second);
    for (const Slot slot : place) busy[slot] = 1;
    const GraphEdit edit = renumbered(std::move(proposal.edit), first, next);
    next += static_cast<Slot>(edit.add_patches.size());
    draft.apply(edit);
    any = true;
  }
  return any;
}

}  // namespace

graph::AttributeGraph refine(const graph::AttributeGraph& graph, const cv::Mat& levels,
                             std::span<const CodingContext> axes, const RefineOptions& refinement) {
  EditableGraph draft(judged(graph, axes));
  FitCache cache;
  for (int i = 0; i < kMostRounds; ++i) {
    ProposalBuilder editor(draft, levels, axes, refinement, cache);
    propose_for_strokes(editor);
    propose_at_ends(editor);
    propose_meetings(editor);
    if (!apply_best(draft, editor.take_proposals())) break;
  }
  return draft.graph();
}

}  // namespace emberfold::sketch
