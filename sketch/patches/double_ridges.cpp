// SPDX-License-Identifier: Apache-2.0
#include "sketch/patches/double_ridges.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "core/math/robust.hpp"
#include "sketch/patches/double_profile.hpp"
#include "sketch/refinement/drawing_cost.hpp"
#include "sketch/refinement/proposals.hpp"

namespace emberfold::sketch {

using graph::Patch;
using graph::Point;

namespace {

constexpr double kFarthest = 16;          // px between the lines' middles
constexpr double kParallel = 0.3;         // rad
constexpr std::size_t kLeastPatches = 3;  // of a double ridge
constexpr std::size_t kNear = 3;          // patches before and after one
constexpr std::size_t kMostRest = 2;      // patches of a line's end that go with it

Point normal(const Patch& patch) {
  return {-std::sin(patch.theta), std::cos(patch.theta)};
}

Patch turn_patch(Patch patch) {
  patch.theta = std::remainder(patch.theta + std::numbers::pi, 2 * std::numbers::pi);
  std::swap(patch.left, patch.right);
  return patch;
}

template <class Number>
double median_of(std::span<const Patch> patches, const Number& number) {
  std::vector<double> numbers;
  for (const Patch& patch : patches) numbers.push_back(number(patch));
  return core::median(std::move(numbers));
}

/// A patch of another line to the right of one, and how far.
struct Facing {
  Slot slot;
  double across;
};

/// Patches of a stroke, `first` to `last`, beside those of another, on their right or on their left.
struct Pair {
  const std::vector<Slot>* stroke;
  const std::vector<Slot>* other;
  std::size_t first, last;              ///< of the stroke
  std::size_t other_first, other_last;  ///< of the other, those beside `first` and `last`
  std::vector<Patch> ridges;            ///< the double ridge's patches, along the stroke
};

class Pairing {
 public:
  Pairing(const EditableGraph& draft, const ProposalBuilder& editor, const cv::Mat& levels,
          const CodingContext& luma)
      : draft_(draft),
        editor_(editor),
        levels_(levels),
        luma_(luma),
        strokes_(find_strokes(draft)),
        of_(draft.slots(), kNone),
        at_(draft.slots(), 0) {
    for (std::size_t i = 0; i < strokes_.size(); ++i)
      for (std::size_t k = strokes_[i].size(); k-- > 0;)
        if (const Slot slot = strokes_[i][k]; is_line(slot)) of_[slot] = i, at_[slot] = k;
  }

  std::vector<Proposal> proposals() {
    std::vector<Proposal> all;
    for (std::size_t i = 0; i < strokes_.size(); ++i)
      for (const bool backwards : {false, true})
        for (const Pair& pair : pairs(i, backwards)) propose(all, pair);
    return all;
  }

 private:
  enum class Rests { go, stay };  ///< of lines, beyond an end of the double ridge
  static constexpr std::size_t kNone = ~std::size_t{0};

  [[nodiscard]] bool is_line(Slot slot) const {
    const Patch& patch = draft_.patch(slot);
    const auto degree = draft_.degree(slot);
    return (degree == 1 || degree == 2) && !graph::on_step(patch) && patch.hollow <= 0;
  }

  /// The nearest line of the patch's sign that runs beside it on its right, in another stroke.
  [[nodiscard]] std::optional<Facing> facing(Slot slot, const Patch& patch) const {
    std::optional<Facing> nearest;
    const Point n = normal(patch);
    for (const Slot other : editor_.patches_near(patch.position)) {
      const Patch& candidate = draft_.patch(other);
      if (of_[other] == kNone || of_[other] == of_[slot] || (candidate.contrast > 0) != (patch.contrast > 0))
        continue;
      if (graph::orientation_difference(candidate.theta, patch.theta) > kParallel) continue;
      const Point gap = candidate.position - patch.position;
      if (std::abs(gap.x * n.y - gap.y * n.x) > 0.6 * editor_.spacing()) continue;
      // As far as the other line's tangent, so that it does not matter where along it the patch lies.
      const double across = graph::dot(gap, normal(candidate)) / graph::dot(n, normal(candidate));
      const double least = (patch.width + candidate.width) / 2;
      if (across < std::max(least, 2.0) || across > kFarthest) continue;
      if (!nearest || across < nearest->across) nearest = {other, across};
    }
    return nearest;
  }

  [[nodiscard]] std::optional<Patch> fitted(const Patch& start, DoubleFit fit) const {
    return fit_double_ridge(levels_, start, make_ribs(start.position, start.theta, editor_.spacing()),
                            luma_.noise, fit);
  }

  /// A thin line's width and brightness show only together, but it keeps its width: each gets the usual one
  /// of its neighbourhood.
  void even_out(std::vector<Patch>& ridges) const {
    const std::vector<Patch> before = ridges;
    for (std::size_t i = 0; i < ridges.size(); ++i) {
      const std::size_t first = i < kNear ? 0 : i - kNear, last = std::min(i + kNear + 1, before.size());
      const auto near = std::span(before).subspan(first, last - first);
      const double thickness = median_of(near, [](const Patch& p) { return (p.width - p.hollow) / 2; });
      Patch start = ridges[i];
      start.width = start.hollow + 2 * thickness;
      start.blur = median_of(near, [](const Patch& p) { return p.blur; });
      if (const auto even = fitted(start, DoubleFit::place)) ridges[i] = *even;
    }
  }

  /// The double ridge of a patch and what faces it on its right.
  [[nodiscard]] std::optional<Patch> ridge(const Patch& patch, const Facing& facing) const {
    Patch other = draft_.patch(facing.slot);
    if (std::cos(other.theta - patch.theta) < 0) other = turn_patch(other);
    Patch start = patch;
    start.theta += std::remainder(other.theta - patch.theta, 2 * std::numbers::pi) / 2;
    start.position = patch.position + normal(patch) * (facing.across / 2);
    const double thickness = (patch.width + other.width) / 2;
    start.width = facing.across + thickness;
    start.hollow = facing.across - thickness;
    start.blur = (patch.blur + other.blur) / 2;
    if (start.width > kWidestDouble) return std::nullopt;
    return fitted(start, DoubleFit::all);
  }

  /// Each pair is found from both strokes: what pays more does not depend on which comes first.
  [[nodiscard]] std::vector<Pair> pairs(std::size_t stroke, bool backwards) const {
    std::vector<Pair> found;
    std::optional<Pair> open;
    const auto close = [&] {
      if (open && open->ridges.size() >= kLeastPatches) {
        even_out(open->ridges);
        found.push_back(std::move(*open));
      }
      open.reset();
    };
    const std::vector<Slot>& slots = strokes_[stroke];
    const bool closed = slots.size() > 2 && slots.front() == slots.back();
    for (std::size_t k = 0; k + (closed ? 1 : 0) < slots.size(); ++k) {
      std::optional<Patch> here;
      std::optional<Facing> beside;
      if (of_[slots[k]] == stroke) {
        const Patch patch = backwards ? turn_patch(draft_.patch(slots[k])) : draft_.patch(slots[k]);
        beside = facing(slots[k], patch);
        if (beside) here = ridge(patch, *beside);
      }
      if (!here) {
        close();
        continue;
      }
      const std::vector<Slot>* other = &strokes_[of_[beside->slot]];
      if (open && open->other != other) close();
      if (!open) open = Pair{&slots, other, k, k, at_[beside->slot], at_[beside->slot], {}};
      open->last = k;
      open->other_last = at_[beside->slot];
      open->ridges.push_back(*here);
    }
    close();
    return found;
  }

  /// Ties an end of the double ridge to what goes on of a line beyond `from`, unless that is a short rest
  /// and those go.
  void go_on(GraphEdit& edit, const std::vector<Slot>& stroke, std::size_t from, bool forwards, Slot end,
             Rests rests) const {
    const std::size_t rest = forwards ? stroke.size() - 1 - from : from;
    if (rest == 0) return;
    const Slot tip = forwards ? stroke.back() : stroke.front();
    if (rests == Rests::go && rest <= kMostRest && draft_.degree(tip) == 1) {
      for (std::size_t i = 1; i <= rest; ++i)
        remove_patch(edit, draft_, stroke[forwards ? from + i : from - i]);
      return;
    }
    const SlotEdge both = make_edge(stroke[forwards ? from + 1 : from - 1], end);
    if (std::find(edit.add_edges.begin(), edit.add_edges.end(), both) == edit.add_edges.end())
      edit.add_edges.push_back(both);
  }

  [[nodiscard]] static bool removed(const GraphEdit& edit, Slot slot) {
    return std::find(edit.remove_patches.begin(), edit.remove_patches.end(), slot) !=
           edit.remove_patches.end();
  }

  [[nodiscard]] static bool tied(const GraphEdit& edit, Slot slot) {
    return std::ranges::any_of(edit.add_edges,
                               [&](const SlotEdge& t) { return t.first == slot || t.second == slot; });
  }

  /// Removes patches that lie on the ridges, and patches that would be left alone. False where that would
  /// remove a meeting of others.
  bool clear(GraphEdit& edit, const std::vector<Patch>& ridges) const {
    for (const Patch& ridge : ridges)
      for (const Slot slot : editor_.patches_near(ridge.position)) {
        if (removed(edit, slot) || tied(edit, slot) || !patches_overlap(ridge, draft_.patch(slot))) continue;
        if (draft_.degree(slot) > 2) return false;
        remove_patch(edit, draft_, slot);
      }
    const std::vector<Slot> gone = edit.remove_patches;
    for (const Slot slot : gone)
      for (const Slot next : draft_.neighbours(slot))
        if (!removed(edit, next) && !tied(edit, next) &&
            std::ranges::all_of(draft_.neighbours(next), [&](Slot other) { return removed(edit, other); }))
          remove_patch(edit, draft_, next);
    return true;
  }

  /// Builds the edit that replaces a pair by its double ridge; nothing if that is impossible.
  [[nodiscard]] std::optional<GraphEdit> edit_of(const Pair& pair, Rests rests) const {
    const auto [low, high] = std::minmax(pair.other_first, pair.other_last);
    const bool along = pair.other_first <= pair.other_last;
    GraphEdit edit;
    for (std::size_t k = pair.first; k <= pair.last; ++k) remove_patch(edit, draft_, (*pair.stroke)[k]);
    for (std::size_t k = low; k <= high; ++k) {
      if (of_[(*pair.other)[k]] == kNone || removed(edit, (*pair.other)[k])) return std::nullopt;
      remove_patch(edit, draft_, (*pair.other)[k]);
    }
    const Slot first = draft_.slots();
    for (const Patch& ridge : pair.ridges) {
      const Slot slot = first + static_cast<Slot>(edit.add_patches.size());
      edit.add_patches.emplace_back(slot, editor_.with_coding_cost(ridge));
      if (slot > first) edit.add_edges.push_back(make_edge(slot - 1, slot));
    }
    const Slot last = first + static_cast<Slot>(pair.ridges.size()) - 1;
    go_on(edit, *pair.stroke, pair.first, false, first, rests);
    go_on(edit, *pair.stroke, pair.last, true, last, rests);
    go_on(edit, *pair.other, low, false, along ? first : last, rests);
    go_on(edit, *pair.other, high, true, along ? last : first, rests);
    if (!clear(edit, pair.ridges)) return std::nullopt;
    for (const SlotEdge& t : edit.add_edges)
      if (removed(edit, t.first) || removed(edit, t.second)) return std::nullopt;
    return edit;
  }

  void propose(std::vector<Proposal>& all, const Pair& pair) const {
    std::size_t gone = 0;
    for (const Rests rests : {Rests::go, Rests::stay}) {
      std::optional<GraphEdit> edit = edit_of(pair, rests);
      if (!edit || edit->remove_patches.size() == gone) continue;  // there is no such rest
      gone = edit->remove_patches.size();
      const double change = drawing_cost_change(draft_, *edit, luma_);
      if (!(change < -1)) continue;
      std::vector<Slot> concerns = edit->remove_patches;
      for (const SlotEdge& t : edit->add_edges)
        if (t.first < draft_.slots()) concerns.push_back(t.first);
      all.push_back({change, std::move(*edit), std::move(concerns)});
    }
  }

  const EditableGraph& draft_;
  const ProposalBuilder& editor_;
  const cv::Mat& levels_;
  const CodingContext& luma_;
  std::vector<std::vector<Slot>> strokes_;
  std::vector<std::size_t> of_, at_;  ///< of a line's patch: its stroke, and which one of it
};

}  // namespace

graph::AttributeGraph merge_double_ridges(const graph::AttributeGraph& graph, const cv::Mat& levels,
                                          const CodingContext& luma, double spacing) {
  EditableGraph draft(graph);
  FitCache cache;
  const ProposalBuilder editor(draft, levels, {&luma, 1}, {spacing}, cache);
  apply_best(draft, Pairing(draft, editor, levels, luma).proposals());
  return draft.graph();
}

}  // namespace emberfold::sketch
