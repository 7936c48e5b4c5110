// SPDX-License-Identifier: Apache-2.0
// Ends of strokes grow and shrink.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sketch/refinement/proposals.hpp"

namespace emberfold::sketch {

using graph::Patch;
using graph::Point;

namespace {

constexpr double kShows = 0.5;    // of the contrast, all the way
constexpr std::size_t kMost = 4;  // patches that an end grows or shrinks by at once

void shrink(ProposalBuilder& editor, const std::vector<Slot>& slots) {
  GraphEdit edit;
  for (std::size_t n = 0; n < std::min(kMost, slots.size() - 1); ++n) {
    if (n > 0 && editor.draft().degree(slots[n]) != 2) return;
    remove_patch(edit, editor.draft(), slots[n]);
    editor.propose(edit, {slots.begin(), slots.begin() + static_cast<std::ptrdiff_t>(n + 2)});
  }
}

double turn_between(double from, double to) {
  return std::remainder(to - from, 2 * std::numbers::pi);
}

void grow(ProposalBuilder& editor, const std::vector<Slot>& slots) {
  const EditableGraph& draft = editor.draft();
  Patch last = draft.patch(slots[0]);
  const Point back = last.position - draft.patch(slots[1]).position;
  double heading = std::atan2(back.y, back.x), bend = 0;
  if (slots.size() > 2) {
    constexpr double kMostBend = 0.5;  // rad a patch
    const Point before = draft.patch(slots[1]).position - draft.patch(slots[2]).position;
    bend = std::clamp(turn_between(std::atan2(before.y, before.x), heading), -kMostBend, kMostBend) / 2;
  }
  const bool backwards = std::cos(last.theta - heading) < 0;
  const double contrast = std::copysign(median_contrast(draft, slots), last.contrast);
  GraphEdit edit;
  for (std::size_t n = 0; n < kMost; ++n) {
    heading += bend;
    const Point place = last.position + Point{std::cos(heading), std::sin(heading)} * editor.spacing();
    // Beyond a gap the stroke is another one.
    if (editor.visible_contrast(last, last.position, place, contrast, kShows) < kShows) return;
    const auto next =
        editor.fit_like(last, place, backwards ? heading + std::numbers::pi : heading, contrast);
    if (!next || editor.overlaps(*next, {slots.data(), 1})) return;
    const Slot slot = draft.slots() + static_cast<Slot>(n);
    edit.add_patches.emplace_back(slot, *next);
    edit.add_edges.push_back(n == 0 ? make_edge(slots[0], slot) : make_edge(slot - 1, slot));
    editor.propose(edit, {slots[0]});
    last = *next;
  }
}

}  // namespace

void propose_at_ends(ProposalBuilder& editor) {
  const EditableGraph& draft = editor.draft();
  for (Slot end = 0; end < draft.slots(); ++end) {
    if (!draft.holds(end) || draft.degree(end) != 1) continue;
    const std::vector<Slot> slots = stroke_tail(draft, end);
    shrink(editor, slots);
    grow(editor, slots);
  }
}

}  // namespace emberfold::sketch
