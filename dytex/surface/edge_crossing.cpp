// SPDX-License-Identifier: Apache-2.0
#include "dytex/surface/edge_crossing.hpp"

#include <cmath>

namespace emberfold::dytex::detail {

EdgeSide::EdgeSide(const SurfaceLayout& layout, const GluedSide& side, const SurfaceFrame& frame)
    : frame_(frame), from_(side.from) {
  const cv::Point2d edge = frame.to_surface(side.to - side.from);
  length_ = std::hypot(edge.x, edge.y);
  along_ = length_ > 0 ? edge / length_ : cv::Point2d(1, 0);
  beyond_ = {along_.y, -along_.x};
  const auto inside = layout.centres[static_cast<std::size_t>(side.triangle)];
  if (frame.to_surface(inside - side.from).dot(beyond_) > 0) beyond_ = -beyond_;
}

EdgeSide::Place EdgeSide::place(const cv::Point2d& texel) const {
  const cv::Point2d step = frame_.to_surface(texel - from_);
  return {step.dot(along_), step.dot(beyond_)};
}

cv::Point2d EdgeSide::texel(const Place& place) const {
  return from_ + frame_.to_texels(place.along * along_ + place.beyond * beyond_);
}

EdgeCrossing::EdgeCrossing(const SurfaceLayout& layout, const GluedSide& here, const SurfaceFrame& frame,
                           const GluedSide& there)
    : here_(layout, here, frame),
      there_(layout, there, frame_of_side(layout, there)),
      chart_(chart_of_side(layout, there)) {}

EdgeCrossing::EdgeCrossing(const SurfaceLayout& layout, const GluedSide& here, const GluedSide& there)
    : EdgeCrossing(layout, here, frame_of_side(layout, here), there) {}

cv::Point2d EdgeCrossing::over(const EdgeSide::Place& place) const {
  const double share = here_.length() > 0 ? there_.length() / here_.length() : 1;
  return there_.texel({place.along * share, -place.beyond});
}

cv::Point EdgeCrossing::texel_over(const SurfaceLayout& layout, EdgeSide::Place place) const {
  for (int attempt = 0; attempt < 2; ++attempt, place.beyond += 1) {
    const cv::Point texel = nearest_texel(over(place));
    if (layout.chart_at(texel) == chart_) return texel;
  }
  return {-1, -1};
}

cv::Point nearest_texel(const cv::Point2d& place) {
  return {static_cast<int>(std::floor(place.x + 0.5)), static_cast<int>(std::floor(place.y + 0.5))};
}

}  // namespace emberfold::dytex::detail
