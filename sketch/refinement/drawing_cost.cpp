// SPDX-License-Identifier: Apache-2.0
#include "sketch/refinement/drawing_cost.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "graph/matching/point_grid.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/rendering/render.hpp"

namespace emberfold::sketch {

using graph::Patch;
using graph::Point;

namespace {

constexpr double kMargin = 24;  // px about an edit: what may show among its pixels

/// Places of the removed and added patches.
std::vector<Point> places_of(const EditableGraph& draft, const GraphEdit& edit) {
  std::vector<Point> places;
  for (const Slot slot : edit.remove_patches) places.push_back(draft.patch(slot).position);
  for (const auto& [slot, patch] : edit.add_patches) places.push_back(patch.position);
  return places;
}

/// The pixels about them.
cv::Rect box_of(const std::vector<Point>& places, cv::Size size) {
  double left = size.width, right = 0, top = size.height, bottom = 0;
  for (const Point p : places) {
    left = std::min(left, p.x), right = std::max(right, p.x);
    top = std::min(top, p.y), bottom = std::max(bottom, p.y);
  }
  const cv::Rect box(cv::Point(static_cast<int>(left - kMargin), static_cast<int>(top - kMargin)),
                     cv::Point(static_cast<int>(right + kMargin), static_cast<int>(bottom + kMargin)));
  return box & cv::Rect({}, size);
}

/// Draws the patches near these places within the box. The rest is the same before and after.
Sketchable draw_box(const EditableGraph& draft, const graph::detail::PointGrid& places, const cv::Rect& box) {
  std::vector<std::optional<graph::VertexId>> id(draft.slots());
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  const Point corner{static_cast<double>(box.x), static_cast<double>(box.y)};
  for (Slot slot = 0; slot < draft.slots(); ++slot) {
    if (!draft.holds(slot) || places.find_near(draft.patch(slot).position).empty()) continue;
    Patch patch = draft.patch(slot);
    patch.position = patch.position - corner;
    id[slot] = {static_cast<std::uint32_t>(vertices.size())};
    vertices.push_back({*id[slot], {}, patch});
    for (const Slot other : draft.neighbours(slot))
      if (other < slot && id[other]) edges.push_back({*id[other], *id[slot]});
  }
  return draw_fitted({std::move(vertices), std::move(edges)}, box.size(), 1);
}

}  // namespace

double drawing_cost_change(const EditableGraph& draft, const GraphEdit& edit, const CodingContext& luma) {
  const std::vector<Point> places = places_of(draft, edit);
  const cv::Rect box = box_of(places, luma.luma.size());
  if (box.empty()) return 0;
  const graph::detail::PointGrid near(places, kMargin);
  EditableGraph edited = draft;
  edited.apply(edit);
  const Sketchable before = draw_box(draft, near, box), after = draw_box(edited, near, box);
  const cv::Mat1f seen = luma.luma(box);
  cv::Mat either, beyond;
  cv::bitwise_or(before.mask, after.mask, either);
  cv::bitwise_not(either, beyond);
  const auto squared_error = [&](const Sketchable& shown) {
    cv::Mat levels = seen.clone(), held;
    shown.levels.copyTo(levels, shown.mask);
    cv::bitwise_or(shown.mask, beyond, held);
    return cv::norm(fill(levels, held).levels, seen, cv::NORM_L2SQR);
  };
  double costs = draft.change(edit);  // of the degrees, once the gains are taken off
  for (const Slot slot : edit.remove_patches) costs -= draft.patch(slot).gain + draft.patch(slot).cost;
  for (const auto& [slot, patch] : edit.add_patches) costs += patch.gain + patch.cost;
  const double noise = 2 * luma.noise * luma.noise * luma.noise_correlation[1];
  return (squared_error(after) - squared_error(before)) / noise + costs;
}

}  // namespace emberfold::sketch
