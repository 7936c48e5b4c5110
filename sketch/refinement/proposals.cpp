// SPDX-License-Identifier: Apache-2.0
#include "sketch/refinement/proposals.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/math/bilinear.hpp"
#include "core/math/luma.hpp"
#include "core/math/robust.hpp"
#include "sketch/detection/contrast_gaps.hpp"

namespace emberfold::sketch {

using graph::Patch;
using graph::Point;

namespace {

std::vector<Slot> slots_held(const EditableGraph& draft) {
  std::vector<Slot> held;
  for (Slot slot = 0; slot < draft.slots(); ++slot)
    if (draft.holds(slot)) held.push_back(slot);
  return held;
}

std::vector<Point> places(const EditableGraph& draft, const std::vector<Slot>& held) {
  std::vector<Point> points;
  for (const Slot slot : held) points.push_back(draft.patch(slot).position);
  return points;
}

constexpr double kOwnLength = 3;  // px along a patch that are its own

double own_across(const Patch& patch) {
  constexpr double kLeast = 1.5;
  return std::max(kLeast, patch.width / 2 + patch.blur);
}

bool lies_on(const Patch& patch, Point place) {
  const Point apart = place - patch.position;
  const double c = std::cos(patch.theta), s = std::sin(patch.theta);
  return std::abs(apart.x * c + apart.y * s) <= kOwnLength &&
         std::abs(apart.y * c - apart.x * s) <= own_across(patch);
}

double level_at(const cv::Mat1f& luma, Point p) {
  return core::sample_bilinear(luma, p.x, p.y);
}

/// Distance at which a patch's sides are sampled: the levels there are nearly left and right.
double flank_distance(const Patch& patch) {
  return patch.width / 2 + 1.5 * patch.blur;
}

/// A line's middle above its sides, a step's right above its left, at one place.
double contrast_across(const cv::Mat1f& luma, const Patch& patch, Point place, Point normal) {
  const double d = flank_distance(patch);
  const double left = level_at(luma, place - normal * d), right = level_at(luma, place + normal * d);
  if (graph::on_step(patch)) return right - left;
  const double in = std::min(patch.width / 4, 1.0);
  return 0.5 * (level_at(luma, place - normal * in) + level_at(luma, place + normal * in)) -
         0.5 * (left + right);
}

/// Expected difference, from the patch's own profile.
double difference(const Patch& patch) {
  const auto reached = [&](double d) { return 0.5 * std::erfc(-d / (std::numbers::sqrt2 * patch.blur)); };
  const double d = flank_distance(patch);
  if (graph::on_step(patch)) return patch.contrast * (reached(d) - reached(-d));
  const double half = patch.width / 2, in = std::min(patch.width / 4, 1.0);
  const auto core = [&](double at) { return reached(at + half) - reached(at - half); };
  return patch.contrast / core(0) * (core(in) - core(d));
}

/// A line's middle lies beyond both its sides; else it is the flank of something.
bool stands_out(const Patch& patch) {
  constexpr double kLeast = 0.25;  // of the contrast
  if (graph::on_step(patch)) return true;
  const auto luma = [](const graph::Level& level) {
    return core::luma(double{level[0]}, double{level[1]}, double{level[2]});
  };
  const double sign = patch.contrast >= 0 ? 1 : -1, middle = luma(patch.middle);
  const double least = kLeast * std::abs(patch.contrast);
  return sign * (middle - luma(patch.left)) > least && sign * (middle - luma(patch.right)) > least;
}

CreaseKind kind_of(const Patch& patch) {
  if (graph::on_step(patch)) return CreaseKind::step;
  return patch.contrast >= 0 ? CreaseKind::ridge : CreaseKind::valley;
}

/// Returns the ribs of a straight patch, one a pixel.
std::vector<Rib> make_ribs(Point position, double theta, double length) {
  const Point along{std::cos(theta), std::sin(theta)}, across{-along.y, along.x};
  const int rows = std::max(1, static_cast<int>(std::lround(length)));
  std::vector<Rib> ribs;
  for (int r = 0; r < rows; ++r) ribs.push_back({position + along * (r - 0.5 * (rows - 1)), across});
  return ribs;
}

}  // namespace

bool patches_overlap(const Patch& a, const Patch& b) {
  // Most are too far apart, however they lie; a millionth more than rounding makes.
  const double across = std::max(own_across(a), own_across(b));
  const Point apart = b.position - a.position;
  if (graph::dot(apart, apart) > 1.000001 * (kOwnLength * kOwnLength + across * across)) return false;
  return lies_on(a, b.position) || lies_on(b, a.position);
}

Coding best_coding(std::span<const CodingContext> axes, const Patch& patch) {
  Coding best;
  for (const CodingContext& frame : axes)
    if (const Coding told = code_patch(frame, patch);
        &frame == axes.data() || told.gain > std::max(best.gain, 0.0))
      best = told;
  return best;
}

ProposalBuilder::ProposalBuilder(const EditableGraph& draft, const cv::Mat& levels,
                                 std::span<const CodingContext> axes, const RefineOptions& refinement,
                                 FitCache& cache)
    : draft_(draft),
      levels_(levels),
      axes_(axes),
      refinement_(refinement),
      cache_(cache),
      held_(slots_held(draft)),
      near_(places(draft, held_), kRadius) {}

double ProposalBuilder::visible_contrast(const Patch& patch, Point from, Point to, double contrast,
                                         double enough) const {
  const Point step = to - from;
  const double length = graph::norm(step), expected = difference(patch);
  if (!(length > 0) || std::abs(expected) < 1e-6 || contrast == 0) return 0;
  const Point along = step * (1 / length);
  const bool backwards = along.x * std::cos(patch.theta) + along.y * std::sin(patch.theta) < 0;
  const Point normal = backwards ? Point{along.y, -along.x} : Point{-along.y, along.x};
  const auto third = [&](int i) {
    return contrast_across(axes_[0].luma, patch, from + along * i, normal) / 3;
  };
  double least = 1, before = 0, here = third(0), after = third(1);
  for (int i = 1; i < length && least >= enough; ++i) {
    before = std::exchange(here, std::exchange(after, third(i + 1)));
    least = std::min(least, (before + here + after) / expected * std::abs(patch.contrast / contrast));
  }
  return least;
}

bool ProposalBuilder::shows_gap(const std::vector<Slot>& before, const std::vector<Slot>& after) const {
  constexpr double kShare = 0.5;  // a stroke is there as far as it shows at half of its contrast
  const Patch &a = draft_.patch(before.front()), &b = draft_.patch(after.front());
  std::vector<Point> corners;
  for (auto slot = before.rbegin(); slot != before.rend(); ++slot)
    corners.push_back(draft_.patch(*slot).position);
  for (const Slot slot : after) corners.push_back(draft_.patch(slot).position);
  Chain way{graph::on_step(a) ? CreaseKind::step
            : a.contrast > 0  ? CreaseKind::ridge
                              : CreaseKind::valley,
            {},
            false};
  const auto at = [](Point place) {
    CreasePoint point;
    point.position = place;
    return point;
  };
  std::size_t first = 0, last = 0;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {  // a point a pixel
    const Point step = corners[i + 1] - corners[i];
    const int pieces = std::max(1, static_cast<int>(std::lround(graph::norm(step))));
    if (i + 1 == before.size()) first = way.points.size(), last = first + static_cast<std::size_t>(pieces);
    for (int k = 0; k < pieces; ++k) way.points.push_back(at(corners[i] + step * (1.0 * k / pieces)));
  }
  way.points.push_back(at(corners.back()));
  const auto variance = [](const Patch& patch) {
    return patch.blur * patch.blur + patch.width * patch.width / 12;
  };
  return sketch::shows_gap(way, first, last, axes_[0].luma, std::sqrt(0.5 * (variance(a) + variance(b))),
                           {kShare, axes_[0].noise, 0});
}

Patch ProposalBuilder::with_coding_cost(Patch patch) const {
  const Coding told = best_coding(axes_, patch);
  patch.cost = told.cost;
  patch.gain = told.gain;
  return patch;
}

std::optional<Patch> ProposalBuilder::fit_like(const Patch& patch, Point position, double theta,
                                               double contrast) {
  const auto [found, fresh] =
      cache_.try_emplace({position.x, position.y, theta, contrast, patch.width, patch.blur, patch.contrast,
                          graph::on_step(patch) ? 1.0 : 0.0});
  if (fresh) found->second = fitted_like(patch, position, theta, contrast);
  return found->second;
}

std::optional<Patch> ProposalBuilder::fitted_like(const Patch& patch, Point position, double theta,
                                                  double contrast) const {
  if (position.x < 0 || position.y < 0 || position.x > levels_.cols - 1 || position.y > levels_.rows - 1)
    return std::nullopt;
  // A step points so that its brighter side is on the right.
  const bool turned = graph::on_step(patch) && patch.contrast < 0;
  const double spread = std::sqrt(patch.blur * patch.blur + patch.width * patch.width / 12);
  theta = std::remainder(theta, 2 * std::numbers::pi);
  const Patch made =
      fit_patch(levels_, position, theta, kind_of(patch), make_ribs(position, theta, refinement_.spacing),
                {spread, true, axes_[0].noise});
  const double sign = kind_of(patch) == CreaseKind::valley || turned ? -1 : 1;
  if (sign * made.contrast < 0.5 * std::abs(contrast) || !stands_out(made)) return std::nullopt;
  return with_coding_cost(made);
}

bool ProposalBuilder::overlaps(const Patch& patch, std::span<const Slot> besides) const {
  for (const Slot slot : patches_near(patch.position)) {
    if (std::find(besides.begin(), besides.end(), slot) != besides.end()) continue;
    const Patch& other = draft_.patch(slot);
    if (patches_overlap(patch, other)) return true;
  }
  return false;
}

std::vector<Slot> ProposalBuilder::patches_near(Point place) const {
  std::vector<Slot> found = near_.find_near(place);
  for (Slot& slot : found) slot = held_[slot];
  return found;
}

void ProposalBuilder::propose(GraphEdit edit, std::vector<Slot> concerns) {
  constexpr double kLeast = 1;  // nat
  const double change = draft_.change(edit);
  if (change < -kLeast) proposals_.push_back({change, std::move(edit), std::move(concerns)});
}

std::vector<std::vector<Slot>> find_strokes(const EditableGraph& draft) {
  std::vector<std::vector<Slot>> all;
  std::vector<char> seen(draft.slots(), 0);
  const auto walk = [&](Slot from, Slot next) {
    std::vector<Slot> stroke{from, next};
    while (draft.degree(stroke.back()) == 2 && stroke.back() != from) {
      seen[stroke.back()] = 1;
      const auto sides = draft.neighbours(stroke.back());
      stroke.push_back(sides[0] == stroke[stroke.size() - 2] ? sides[1] : sides[0]);
    }
    return stroke;
  };
  for (Slot slot = 0; slot < draft.slots(); ++slot) {
    if (!draft.holds(slot) || draft.degree(slot) == 2) continue;
    if (draft.degree(slot) == 0) all.push_back({slot});
    for (const Slot next : draft.neighbours(slot)) {
      std::vector<Slot> stroke = walk(slot, next);
      // Each is walked from both ends; the one that starts lower stays.
      if (std::pair(stroke.front(), stroke[1]) <= std::pair(stroke.back(), stroke[stroke.size() - 2]))
        all.push_back(std::move(stroke));
    }
  }
  for (Slot slot = 0; slot < draft.slots(); ++slot)
    if (draft.holds(slot) && draft.degree(slot) == 2 && seen[slot] == 0) {
      seen[slot] = 1;
      all.push_back(walk(slot, draft.neighbours(slot)[0]));
    }
  return all;
}

std::vector<Slot> stroke_tail(const EditableGraph& draft, Slot end) {
  constexpr std::size_t kLong = 6;
  std::vector<Slot> slots{end, draft.neighbours(end)[0]};
  while (slots.size() < kLong && draft.degree(slots.back()) == 2) {
    const auto sides = draft.neighbours(slots.back());
    slots.push_back(sides[0] == slots[slots.size() - 2] ? sides[1] : sides[0]);
  }
  return slots;
}

double median_contrast(const EditableGraph& draft, const std::vector<Slot>& slots) {
  std::vector<double> contrasts;
  for (const Slot slot : slots) contrasts.push_back(std::abs(draft.patch(slot).contrast));
  return core::median(std::move(contrasts));
}

}  // namespace emberfold::sketch
