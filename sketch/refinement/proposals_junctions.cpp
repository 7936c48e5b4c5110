// SPDX-License-Identifier: Apache-2.0
// Strokes meet: ends with ends, ends with strokes, ends in a corner; patches become one.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "sketch/refinement/proposals.hpp"

namespace emberfold::sketch {

using graph::Patch;
using graph::Point;

namespace {

constexpr double kLongest = 16;  // px that a way bridges
constexpr double kClearlyShows =
    0.6;  // more than the half that makes a gap: what is on the verge would flicker

struct End {
  Slot slot;
  Point place, heading;  // out of the stroke
};

std::vector<End> free_ends(const EditableGraph& draft) {
  std::vector<End> ends;
  for (Slot slot = 0; slot < draft.slots(); ++slot) {
    if (!draft.holds(slot) || draft.degree(slot) != 1) continue;
    const Point place = draft.patch(slot).position;
    const Point out = place - draft.patch(draft.neighbours(slot)[0]).position;
    if (const double length = graph::norm(out); length > 0) ends.push_back({slot, place, out * (1 / length)});
  }
  return ends;
}

/// Patches evenly along a step, its ends left out, like the one at its begin; none if one of them does not
/// fit.
std::optional<std::vector<Patch>> row_like(ProposalBuilder& editor, const Patch& begin, Point from,
                                           Point step, double theta, double contrast,
                                           std::span<const Slot> besides) {
  const int pieces = static_cast<int>(std::lround(graph::norm(step) / editor.spacing()));
  std::vector<Patch> patches;
  for (int i = 1; i < pieces; ++i) {
    const auto next = editor.fit_like(begin, from + step * (double(i) / pieces), theta, contrast);
    if (!next || editor.overlaps(*next, besides)) return std::nullopt;
    patches.push_back(*next);
  }
  return patches;
}

/// Patches along the straight way from one place to another, both left out, as the patch at its begin shows
/// it; none if it does not show throughout. `from_side`: rad, a stroke whose direction is another by so much
/// is come to from the side.
std::optional<std::vector<Patch>> straight_path(ProposalBuilder& editor, const Patch& begin, Point from,
                                                const Patch& end, double contrast,
                                                std::span<const Slot> besides,
                                                double from_side = std::numbers::pi / 6) {
  const Point to = end.position, step = to - from;
  const double length = graph::norm(step), heading = std::atan2(step.y, step.x);
  const double theta = std::cos(begin.theta - heading) < 0 ? heading + std::numbers::pi : heading;
  // The sides of a stroke that is met from the side hide the last part of the way.
  const double hidden =
      graph::orientation_difference(heading, end.theta) < from_side ? 0 : end.width / 2 + 2 * end.blur;
  const Point seen_to = from + step * std::max(1 - hidden / length, 0.0);
  if (hidden < length &&
      editor.visible_contrast(begin, from, seen_to, contrast, kClearlyShows) < kClearlyShows)
    return std::nullopt;
  return row_like(editor, begin, from, step, theta, contrast, besides);
}

/// Adds a row of patches between two that are there or are added.
void bridge(GraphEdit& edit, Slot& next, Slot from, const std::vector<Patch>& patches, Slot to) {
  Slot last = from;
  for (const Patch& patch : patches) {
    edit.add_patches.emplace_back(next, patch);
    edit.add_edges.push_back(make_edge(last, next));
    last = next++;
  }
  edit.add_edges.push_back(make_edge(last, to));
}

double fainter(const Patch& a, const Patch& b) {
  return std::abs(a.contrast) < std::abs(b.contrast) ? a.contrast : std::copysign(b.contrast, a.contrast);
}

/// Two ends that point at each other: joined by patches, or, next to each other, made one.
void join_ends(ProposalBuilder& editor, const End& a, const End& b) {
  constexpr double kFacing = 0.7;  // cos 45°
  const EditableGraph& draft = editor.draft();
  const Patch &first = draft.patch(a.slot), &second = draft.patch(b.slot);
  const Point gap = b.place - a.place;
  const double length = graph::norm(gap);
  if (draft.neighbours(a.slot)[0] == b.slot || length > kLongest || !graph::same_kind(first, second)) return;
  if (length >= 0.6 * editor.spacing() &&
      (graph::dot(a.heading, gap) < kFacing * length || graph::dot(b.heading, gap) > -kFacing * length))
    return;
  const auto tail_a = stroke_tail(draft, a.slot), tail_b = stroke_tail(draft, b.slot);
  if (editor.shows_gap(tail_a, tail_b)) return;
  // Medians over both strokes: near a gap their ends have less contrast.
  const double contrast = std::copysign(
      std::sqrt(median_contrast(draft, tail_a) * median_contrast(draft, tail_b)), first.contrast);
  const std::array<Slot, 2> both{a.slot, b.slot};
  if (length < 0.6 * editor.spacing()) {
    if (editor.visible_contrast(first, a.place, b.place, contrast, kClearlyShows) < kClearlyShows) return;
    const Slot before = draft.neighbours(a.slot)[0], after = draft.neighbours(b.slot)[0];
    if (before == after) return;
    const Point along = draft.patch(after).position - draft.patch(before).position;
    const double heading = std::atan2(along.y, along.x);
    const auto one =
        editor.fit_like(first, (a.place + b.place) * 0.5,
                        std::cos(first.theta - heading) < 0 ? heading + std::numbers::pi : heading, contrast);
    if (!one) return;
    GraphEdit edit;
    remove_patch(edit, draft, a.slot);
    remove_patch(edit, draft, b.slot);
    edit.add_patches.emplace_back(draft.slots(), *one);
    edit.add_edges = {make_edge(before, draft.slots()), make_edge(after, draft.slots())};
    editor.propose(std::move(edit), {a.slot, b.slot, before, after});
    return;
  }
  if (const auto patches = straight_path(editor, first, a.place, second, contrast, both)) {
    GraphEdit edit;
    Slot next = draft.slots();
    bridge(edit, next, a.slot, *patches, b.slot);
    editor.propose(std::move(edit), {a.slot, b.slot});
  }
}

/// An end goes on to a stroke that it points at, or to an end, for a corner.
void reach_stroke(ProposalBuilder& editor, const End& end, Slot target) {
  constexpr double kAhead = 0.87;  // cos 30°
  const EditableGraph& draft = editor.draft();
  const Patch &first = draft.patch(end.slot), &hit = draft.patch(target);
  const Point gap = hit.position - end.place;
  if (graph::dot(gap, gap) > 1.000001 * kLongest * kLongest) return;
  const double length = graph::norm(gap);
  if (draft.degree(target) < 1 || length > kLongest || !graph::same_kind(first, hit)) return;
  if (graph::dot(end.heading, gap) < kAhead * length) return;
  if (graph::orientation_difference(std::atan2(gap.y, gap.x), hit.theta) < std::numbers::pi / 6) return;
  std::vector<Slot> besides{end.slot, target};
  besides.insert(besides.end(), draft.neighbours(target).begin(), draft.neighbours(target).end());
  if (std::find(besides.begin(), besides.end(), draft.neighbours(end.slot)[0]) != besides.end()) return;
  // An end has sides only for what comes nearly square to it: before it, nothing hides a gap.
  const double from_side = draft.degree(target) == 1 ? std::numbers::pi / 3 : std::numbers::pi / 6;
  if (const auto patches =
          straight_path(editor, first, end.place, hit, fainter(first, hit), besides, from_side)) {
    GraphEdit edit;
    Slot next = draft.slots();
    bridge(edit, next, end.slot, *patches, target);
    editor.propose(std::move(edit), {end.slot, target});
  }
}

/// Joins two ends whose ways cross ahead of both in a corner.
void meet_in_corner(ProposalBuilder& editor, const End& a, const End& b) {
  const EditableGraph& draft = editor.draft();
  const Patch &first = draft.patch(a.slot), &second = draft.patch(b.slot);
  const double sine = a.heading.x * b.heading.y - a.heading.y * b.heading.x;
  if (std::abs(sine) < 0.5 || !graph::same_kind(first, second)) return;
  const Point gap = b.place - a.place;
  const double of_a = (gap.x * b.heading.y - gap.y * b.heading.x) / sine;
  const double of_b = (gap.x * a.heading.y - gap.y * a.heading.x) / sine;
  if (of_a < 2 || of_b < 2 || of_a > 12 || of_b > 12) return;
  const Point place = a.place + a.heading * of_a;
  const double contrast = fainter(first, second);
  const std::array<Slot, 2> both{a.slot, b.slot};
  const auto corner = editor.fit_like(first, place, first.theta, contrast);
  if (!corner || editor.overlaps(*corner, both)) return;
  const auto from_a = straight_path(editor, first, a.place, *corner, contrast, both);
  const auto from_b = straight_path(editor, second, b.place, *corner, contrast, both);
  if (!from_a || !from_b) return;
  GraphEdit edit;
  const Slot middle = draft.slots();
  edit.add_patches.emplace_back(middle, *corner);
  Slot next = middle + 1;
  bridge(edit, next, a.slot, *from_a, middle);
  bridge(edit, next, b.slot, *from_b, middle);
  editor.propose(std::move(edit), {a.slot, b.slot});
}

/// Corners whose arms make less than 110°; their headings point away from the arms.
std::vector<End> sharp_corners(const EditableGraph& draft) {
  constexpr double kLeastSum = 1.15;  // of the arms' unit vectors: 2 cos 55°
  std::vector<End> corners;
  for (Slot slot = 0; slot < draft.slots(); ++slot) {
    if (!draft.holds(slot) || draft.degree(slot) != 2) continue;
    const Point place = draft.patch(slot).position;
    Point sum;
    for (const Slot arm : draft.neighbours(slot)) {
      const Point away = place - draft.patch(arm).position;
      if (const double length = graph::norm(away); length > 0) sum = sum + away * (1 / length);
    }
    if (const double size = graph::norm(sum); size > kLeastSum)
      corners.push_back({slot, place, sum * (1 / size)});
  }
  return corners;
}

/// Joins two corners back to back, if the stroke is visible between them. Two strokes that cross at a small
/// angle leave such corners. Near the corners the arms hide the stroke's sides.
void join_corners(ProposalBuilder& editor, const End& a, const End& b) {
  constexpr double kFacing = 0.87, kLeast = 6;  // cos 30°; px
  const EditableGraph& draft = editor.draft();
  const Patch &first = draft.patch(a.slot), &second = draft.patch(b.slot);
  const Point gap = b.place - a.place;
  const double length = graph::norm(gap);
  if (length < kLeast || length > kLongest || !graph::same_kind(first, second)) return;
  if (graph::dot(a.heading, gap) < kFacing * length || graph::dot(b.heading, gap) > -kFacing * length) return;
  const std::array<Slot, 2> both{a.slot, b.slot};
  const auto patches =
      row_like(editor, first, a.place, gap, std::atan2(gap.y, gap.x), fainter(first, second), both);
  if (!patches) return;
  GraphEdit edit;
  Slot next = draft.slots();
  bridge(edit, next, a.slot, *patches, b.slot);
  editor.propose(std::move(edit), {a.slot, b.slot});
}

/// Two junctions next to each other become one.
void merge_junctions(ProposalBuilder& editor, Slot a, Slot b) {
  const EditableGraph& draft = editor.draft();
  if (graph::distance(draft.patch(a).position, draft.patch(b).position) > editor.spacing()) return;
  GraphEdit edit;
  remove_patch(edit, draft, b);
  std::vector<Slot> concerns{a, b};
  for (const Slot arm : draft.neighbours(b)) {
    if (arm == a) continue;
    const auto of_a = draft.neighbours(a);
    if (std::find(of_a.begin(), of_a.end(), arm) != of_a.end()) return;  // a triangle stays
    edit.add_edges.push_back(make_edge(a, arm));
    concerns.push_back(arm);
  }
  editor.propose(std::move(edit), std::move(concerns));
}

}  // namespace

void propose_meetings(ProposalBuilder& editor) {
  const EditableGraph& draft = editor.draft();
  const std::vector<End> ends = free_ends(draft);
  std::vector<std::size_t> end_of(draft.slots(), ends.size());
  for (std::size_t i = 0; i < ends.size(); ++i) end_of[ends[i].slot] = i;
  for (std::size_t i = 0; i < ends.size(); ++i)
    for (const Slot slot : editor.patches_near(ends[i].place)) {
      if (slot == ends[i].slot) continue;
      if (const std::size_t j = end_of[slot]; j == ends.size()) {
        reach_stroke(editor, ends[i], slot);
      } else if (i < j) {
        join_ends(editor, ends[i], ends[j]);
        reach_stroke(editor, ends[i], slot);
        reach_stroke(editor, ends[j], ends[i].slot);
        meet_in_corner(editor, ends[i], ends[j]);
      }
    }
  const std::vector<End> corners = sharp_corners(draft);
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = i + 1; j < corners.size(); ++j) join_corners(editor, corners[i], corners[j]);
  for (Slot a = 0; a < draft.slots(); ++a) {
    if (!draft.holds(a) || draft.degree(a) < 3) continue;
    for (const Slot b : draft.neighbours(a))
      if (draft.degree(b) >= 3) merge_junctions(editor, a, b);
  }
}

}  // namespace emberfold::sketch
