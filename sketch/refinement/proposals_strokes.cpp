// SPDX-License-Identifier: Apache-2.0
// Whole strokes go, are cut where they fade, or become a bar together.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "sketch/refinement/proposals.hpp"

namespace emberfold::sketch {

using graph::Patch;
using graph::Point;

namespace {

bool ends_free(const EditableGraph& draft, const std::vector<Slot>& stroke) {
  return draft.degree(stroke.front()) <= 1 && draft.degree(stroke.back()) <= 1;
}

/// The stroke goes, but for the junctions that others share.
void remove_stroke(ProposalBuilder& editor, const std::vector<Slot>& stroke) {
  const EditableGraph& draft = editor.draft();
  GraphEdit edit;
  std::vector<Slot> concerns = stroke;
  for (const Slot slot : stroke)
    if (draft.degree(slot) <= 2 &&
        std::find(edit.remove_patches.begin(), edit.remove_patches.end(), slot) == edit.remove_patches.end())
      remove_patch(edit, draft, slot);
  if (!edit.remove_patches.empty()) editor.propose(std::move(edit), std::move(concerns));
}

/// A patch inside that does not pay and shows less than half of what its neighbours do is a gap.
void cut_faded(ProposalBuilder& editor, const std::vector<Slot>& stroke) {
  const EditableGraph& draft = editor.draft();
  for (std::size_t i = 1; i + 1 < stroke.size(); ++i) {
    const Patch& patch = draft.patch(stroke[i]);
    const double beside = std::min(std::abs(draft.patch(stroke[i - 1]).contrast),
                                   std::abs(draft.patch(stroke[i + 1]).contrast));
    if (worth(patch) > 0 || std::abs(patch.contrast) > 0.5 * beside) continue;
    if (editor.visible_contrast(draft.patch(stroke[i - 1]), draft.patch(stroke[i - 1]).position,
                                draft.patch(stroke[i + 1]).position, beside, 0.5) > 0.5)
      continue;
    GraphEdit edit;
    remove_patch(edit, draft, stroke[i]);
    editor.propose(std::move(edit), {stroke[i - 1], stroke[i], stroke[i + 1]});
  }
}

/// The step, of other polarity, that bounds the same bar on the right of this one.
std::optional<Slot> other_side(const ProposalBuilder& editor, Slot slot) {
  constexpr double kLeast = 3, kWidest = 20;  // px
  const EditableGraph& draft = editor.draft();
  const Patch& step = draft.patch(slot);
  const Point normal{-std::sin(step.theta), std::cos(step.theta)};
  std::optional<Slot> best;
  double nearest = kWidest;
  for (const Slot other : editor.patches_near(step.position)) {
    const Patch& candidate = draft.patch(other);
    if (other == slot || !graph::on_step(candidate) || draft.degree(other) == 0) continue;
    const Point gap = candidate.position - step.position;
    const double across = graph::dot(gap, normal), along = std::abs(gap.x * normal.y - gap.y * normal.x);
    // Both have their right on the inside, or both on the outside: they point in opposite directions.
    if (across < kLeast || across >= nearest || along > 0.6 * editor.spacing()) continue;
    if (std::cos(candidate.theta - step.theta) > -0.94) continue;
    nearest = across;
    best = other;
  }
  return best;
}

/// Two steps that run in parallel, whose bright (or dark) sides face each other, become a bar.
void become_bar(ProposalBuilder& editor, const std::vector<Slot>& stroke,
                const std::vector<std::size_t>& stroke_of, const std::vector<std::vector<Slot>>& all) {
  const EditableGraph& draft = editor.draft();
  if (!ends_free(draft, stroke) || stroke.size() < 3 || !graph::on_step(draft.patch(stroke[1]))) return;
  std::vector<std::pair<Slot, Slot>> pairs;
  std::size_t partner = all.size();
  for (const Slot slot : stroke) {
    const auto other = other_side(editor, slot);
    if (!other) continue;
    const std::size_t of = stroke_of[*other];
    if (of == all.size() || (partner != all.size() && of != partner)) return;
    partner = of;
    pairs.emplace_back(slot, *other);
  }
  if (partner == all.size() || all[partner] == stroke || !ends_free(draft, all[partner])) return;
  const auto longer = std::max(stroke.size(), all[partner].size());
  if (static_cast<double>(pairs.size()) < 0.8 * static_cast<double>(longer)) return;
  GraphEdit edit;
  std::vector<Slot> concerns = stroke;
  concerns.insert(concerns.end(), all[partner].begin(), all[partner].end());
  for (const Slot slot : concerns) remove_patch(edit, draft, slot);
  for (const auto& [one, other] : pairs) {
    const Patch &a = draft.patch(one), &b = draft.patch(other);
    const double width = graph::distance(a.position, b.position);
    // A bar of that width has the levels of the steps' inner and outer sides.
    Patch bar = a;
    bar.position = (a.position + b.position) * 0.5;
    bar.width = width;
    bar.blur = 0.5 * (a.blur + b.blur);
    for (std::size_t c = 0; c < 3; ++c) {
      bar.middle[c] = 0.5F * (a.right[c] + b.right[c]);
      bar.right[c] = b.left[c];
    }
    const double core = 1 - std::erfc(bar.width / (2 * std::numbers::sqrt2 * bar.blur));
    bar.contrast = core * 0.5 * (a.contrast + b.contrast);
    bar.type = bar.contrast > 0 ? graph::PatchType::ridge : graph::PatchType::valley;
    const Slot slot = draft.slots() + static_cast<Slot>(edit.add_patches.size());
    edit.add_patches.emplace_back(slot, editor.with_coding_cost(bar));
    if (edit.add_patches.size() > 1) edit.add_edges.push_back(make_edge(slot - 1, slot));
  }
  editor.propose(std::move(edit), std::move(concerns));
}

}  // namespace

void propose_for_strokes(ProposalBuilder& editor) {
  const auto all = find_strokes(editor.draft());
  std::vector<std::size_t> stroke_of(editor.draft().slots(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    for (const Slot slot : all[i])
      if (editor.draft().degree(slot) <= 2) stroke_of[slot] = i;
  for (const auto& stroke : all) {
    remove_stroke(editor, stroke);
    cut_faded(editor, stroke);
    become_bar(editor, stroke, stroke_of, all);
  }
}

}  // namespace emberfold::sketch
