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

void shrink(Editor& editor, const std::vector<Slot>& slots) {
  Edit edit;
  for (std::size_t n = 0; n < std::min(kMost, slots.size() - 1); ++n) {
    if (n > 0 && editor.draft().degree(slots[n]) != 2) return;
    drop(edit, editor.draft(), slots[n]);
    editor.propose(edit, {slots.begin(), slots.begin() + static_cast<std::ptrdiff_t>(n + 2)});
  }
}

double turned(double from, double to) {
  return std::remainder(to - from, 2 * std::numbers::pi);
}

void grow(Editor& editor, const std::vector<Slot>& slots) {
  const Draft& draft = editor.draft();
  Patch last = draft.patch(slots[0]);
  const Point back = last.position - draft.patch(slots[1]).position;
  double heading = std::atan2(back.y, back.x), bend = 0;
  if (slots.size() > 2) {
    constexpr double kMostBend = 0.5;  // rad a patch
    const Point before = draft.patch(slots[1]).position - draft.patch(slots[2]).position;
    bend = std::clamp(turned(std::atan2(before.y, before.x), heading), -kMostBend, kMostBend) / 2;
  }
  const bool backwards = std::cos(last.theta - heading) < 0;
  const double contrast = std::copysign(usual_contrast(draft, slots), last.contrast);
  Edit edit;
  for (std::size_t n = 0; n < kMost; ++n) {
    heading += bend;
    const Point place = last.position + Point{std::cos(heading), std::sin(heading)} * editor.spacing();
    // What goes on behind a gap is not this stroke.
    if (editor.shown(last, last.position, place, contrast, kShows) < kShows) return;
    const auto next = editor.like(last, place, backwards ? heading + std::numbers::pi : heading, contrast);
    if (!next || editor.overlaps(*next, {slots.data(), 1})) return;
    const Slot slot = draft.slots() + static_cast<Slot>(n);
    edit.add.emplace_back(slot, *next);
    edit.tie.push_back(n == 0 ? tie(slots[0], slot) : tie(slot - 1, slot));
    editor.propose(edit, {slots[0]});
    last = *next;
  }
}

}  // namespace

void propose_at_ends(Editor& editor) {
  const Draft& draft = editor.draft();
  for (Slot end = 0; end < draft.slots(); ++end) {
    if (!draft.holds(end) || draft.degree(end) != 1) continue;
    const std::vector<Slot> slots = tail(draft, end);
    shrink(editor, slots);
    grow(editor, slots);
  }
}

}  // namespace emberfold::sketch
