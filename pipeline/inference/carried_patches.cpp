// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/carried_patches.hpp"

#include <algorithm>
#include <cmath>

#include "graph/matching/coincidence.hpp"
#include "sketch/refinement/amplitude.hpp"

namespace emberfold::pipeline {

using graph::Patch;
using graph::Point;

namespace {

namespace carrying {
constexpr double kFitted = 0.5;       // minimum amplitude in the source frame, relative to the fit
constexpr double kLeastShare = 0.85;  // minimum amplitude elsewhere, relative to the source frame
constexpr double kSlip = 1.5;         // px across the curve that are searched
constexpr double kMargin = 4;         // px minimum distance from the picture's border
constexpr double kAcross = 3;         // px from the line between two drawn patches, and
constexpr double kParallel = 0.6;     // rad from its direction, within which a patch counts as drawn
constexpr double kHalfLength = 2.5;   // px
}  // namespace carrying

Point tangent_of(const Patch& patch) {
  return {std::cos(patch.theta), std::sin(patch.theta)};
}

/// Moves a patch by the flow of what it lies on, by one frame.
Patch moved_along(Patch patch, const FrameWindow& window, int from, int step) {
  const Point half = tangent_of(patch) * carrying::kHalfLength;
  const Point way =
      window.carry(patch.position + half, from, step) - window.carry(patch.position - half, from, step);
  patch.position = window.carry(patch.position, from, step);
  if (norm(way) > 0) patch.theta = std::atan2(way.y, way.x);
  return patch;
}

/// Moves a patch onto the drawn one, except along the curve, where patches look alike.
Patch moved_onto(Patch patch, const Patch& drawn) {
  const Point along = tangent_of(patch), off = drawn.position - patch.position;
  patch.position = patch.position + (off - along * dot(off, along));
  return patch;
}

bool is_within(const cv::Mat& levels, Point p) {
  using carrying::kMargin;
  return p.x >= kMargin && p.y >= kMargin && p.x < levels.cols - kMargin && p.y < levels.rows - kMargin;
}

/// Returns whether the patch is between a drawn one and a neighbour of that, on the same curve.
bool lies_on_edge(const Patch& patch, const graph::AttributeGraph& drawn, std::uint32_t v) {
  const Point from = drawn.patch(v).position;
  return std::ranges::any_of(drawn.neighbours(v), [&](std::uint32_t w) {
    const Point way = drawn.patch(w).position - from, off = patch.position - from;
    const double length = norm(way), along = dot(off, way) / length;
    return same_kind(patch, drawn.patch(v)) && length > 0 && along > 0 && along < length &&
           norm(off - way * (along / length)) <= carrying::kAcross &&
           graph::orientation_difference(patch.theta, std::atan2(way.y, way.x)) <= carrying::kParallel;
  });
}

/// Returns whether the patch is drawn in the previous frame in the sense of `step`; true without such a
/// frame.
bool is_drawn_before(const Patch& patch, int frame, int step, const DrawnPatches& drawn,
                     const FrameWindow& window) {
  const int before = frame - step;
  if (before < 0 || before >= drawn.frames()) return true;
  return drawn.find(before, moved_along(patch, window, frame, -step)).has_value();
}

/// Propagates a patch by one frame. `level`: its amplitude in its source frame; `vertex`: that of the new
/// frame which draws it, if any. Returns false where it is lost.
bool move_on(LastingPatch& carried, int step, double level, const DrawnPatches& drawn,
             const FrameWindow& window, std::optional<std::uint32_t>& vertex) {
  carried.patch = moved_along(carried.patch, window, carried.frame, step);
  carried.frame += step;
  const cv::Mat& levels = window.levels(carried.frame);
  if (!is_within(levels, carried.patch.position)) return false;
  vertex = drawn.find(carried.frame, carried.patch);
  if (vertex) {
    carried.patch = moved_onto(carried.patch, drawn.graph(carried.frame).patch(*vertex));
    return true;
  }
  const auto seen = sketch::measure_amplitude(levels, carried.patch, carrying::kSlip);
  carried.amplitude = seen.value / level;
  const Point along = tangent_of(carried.patch);
  carried.patch.position = carried.patch.position + Point{-along.y, along.x} * seen.slip;
  return carried.amplitude >= carrying::kLeastShare;
}

}  // namespace

void DrawnPatches::hold(int first, int end) {
  for (; first_ < first && !places_.empty(); ++first_) places_.pop_front();
  if (places_.empty()) first_ = first;
  while (first_ + static_cast<int>(places_.size()) < end)
    places_.emplace_back(graph(first_ + static_cast<int>(places_.size())));
}

std::optional<std::uint32_t> DrawnPatches::find(int frame, const Patch& patch) const {
  const graph::CoincidenceIndex& places = places_[static_cast<std::size_t>(frame - first_)];
  if (const auto found = places.find(patch)) return found;
  const auto near = places.find_near(patch.position);
  const auto first =
      std::ranges::find_if(near, [&](std::uint32_t v) { return lies_on_edge(patch, graph(frame), v); });
  return first == near.end() ? std::nullopt : std::optional(*first);
}

CarriedPatches carry_patches(int source, int step, const DrawnPatches& drawn, const FrameWindow& window) {
  CarriedPatches result;
  const graph::AttributeGraph& graph = drawn.graph(source);
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    LastingPatch one{source, source, v, graph.patch(v)};
    if (graph::is_anchor(one.patch) || !is_drawn_before(one.patch, source, step, drawn, window)) continue;
    const double level = sketch::measure_amplitude(window.levels(source), one.patch, 0).value;
    if (level < carrying::kFitted) continue;
    for (int k = 1; k <= kFramesCarried; ++k) {
      const int frame = source + k * step;
      std::optional<std::uint32_t> vertex;
      if (frame < 0 || frame >= drawn.frames() || !move_on(one, step, level, drawn, window, vertex)) break;
      if (vertex)
        result.drawn.push_back({source, frame, v, *vertex});
      else
        result.lasting.push_back(one);
    }
  }
  return result;
}

}  // namespace emberfold::pipeline
