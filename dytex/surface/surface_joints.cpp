// SPDX-License-Identifier: Apache-2.0
// Joints of charts: blocks along glued edges, laid when both sides are filled.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "dytex/surface/edge_crossing.hpp"
#include "dytex/surface/surface_canvas.hpp"

namespace emberfold::dytex::detail {

namespace {

double course_difference(std::span<const Trajectories* const> sources, const SourcePixel& a,
                         const SourcePixel& b) {
  double sum = 0;
  const auto course = [&](const SourcePixel& at, int chunk) {
    const Trajectories& source = *sources[static_cast<std::size_t>(at.source)];
    const auto pixel = static_cast<std::size_t>(at.y) * static_cast<std::size_t>(source.info().width) +
                       static_cast<std::size_t>(at.x);
    return source.chunk(chunk) + pixel * source.course() * CV_ELEM_SIZE1(source.info().depth);
  };
  for (int c = 0; c < sources.front()->chunks(); ++c)
    sum += squared_difference(course(a, c), course(b, c), sources.front()->course(),
                              sources.front()->info().depth);
  return sum;
}

}  // namespace

// Places pieces half a block apart, counted across short edges.
void SurfaceCanvas::find_joints() {
  const cv::Size size = joint_size(options_.block);
  const double apart = std::max(1.0, std::min(size.width, size.height) / 2.0);
  double way = apart / 2;
  for (const auto& [a, b] : layout_.glued) {
    const double length = EdgeSide(layout_, a, frame_of_side(layout_, a)).length();
    const double other = EdgeSide(layout_, b, frame_of_side(layout_, b)).length();
    for (; way < length; way += apart) {
      joints_.push_back({a, b, way});
      joints_.push_back({b, a, way / length * other});
    }
    way -= length;
  }
}

std::optional<BlockRegion> SurfaceCanvas::region_at(const Joint& joint) {
  const EdgeSide side(layout_, joint.own, frame_of_side(layout_, joint.own));
  const cv::Size size = joint_size(options_.block);
  const cv::Point seed = nearest_texel(side.texel({joint.along, -1}));
  if (layout_.chart_at(seed) != chart_of_side(layout_, joint.own)) return std::nullopt;
  // The edge is a quarter of the block from its side.
  const cv::Point2d inward = -side.outward();
  const cv::Point2d cell(0.5 * size.width - 0.25 * size.width * inward.x,
                         0.5 * size.height - 0.25 * size.height * inward.y);
  const cv::Point place = nearest_texel(cell);
  return finder_.find(static_cast<std::int32_t>(layout_.index(seed)),
                      {std::min(place.x, size.width - 1), std::min(place.y, size.height - 1)}, size);
}

std::optional<SurfacePlace> SurfaceCanvas::next_joint() {
  if (!std::exchange(joins_, true)) find_joints();
  while (next_joint_ < joints_.size())
    if (auto region = region_at(joints_[next_joint_++])) return SurfacePlace{std::move(*region), true};
  return std::nullopt;
}

std::vector<BorderCost> SurfaceCanvas::border_costs(const BlockRegion& region, const std::vector<Met>& met,
                                                    std::span<const double> errors) const {
  std::vector<BorderCost> costs(met.size());
  for (std::size_t i = 0; i < met.size(); ++i) {
    if (met[i].block < 0 || met[i].beyond) continue;
    const cv::Point cell = region.cell(static_cast<std::int32_t>(i));
    for (const cv::Point step : {cv::Point(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
      const std::int32_t next = region.cell_index(cell + step);
      if (next < 0 || !met[static_cast<std::size_t>(next)].beyond) continue;
      const SourcePixel& from = met[i].from;
      const cv::Point at(from.x + step.x, from.y + step.y);
      const bool goes_on = cv::Rect({}, courses_[static_cast<std::size_t>(from.source)]->size()).contains(at);
      costs[i].there += 2 * course_difference(courses_, goes_on ? SourcePixel{from.source, at.x, at.y} : from,
                                              met[static_cast<std::size_t>(next)].from);
      costs[i].own += 2 * errors[static_cast<std::size_t>(next)];
    }
  }
  return costs;
}

}  // namespace emberfold::dytex::detail
