// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/types.hpp>

#include "dytex/surface/surface_layout.hpp"

/// Paths across glued edges. Inner header of surfaces.
namespace emberfold::dytex::detail {

/// A side of a glued edge in source pixels along the surface, of the edge's first point.
class EdgeSide {
 public:
  /// `frame`: that of the triangle, or of a block around it.
  EdgeSide(const SurfaceLayout& layout, const GluedSide& side, const SurfaceFrame& frame);

  /// A place by its distance along the edge and beyond it, out of its triangle; below 0 inside.
  struct Place {
    double along = 0, beyond = 0;
  };
  [[nodiscard]] Place place(const cv::Point2d& texel) const;
  [[nodiscard]] cv::Point2d texel(const Place& place) const;
  [[nodiscard]] double length() const { return length_; }
  /// Returns the direction beyond the edge.
  [[nodiscard]] cv::Point2d outward() const { return beyond_; }

 private:
  SurfaceFrame frame_;
  cv::Point2d from_, along_, beyond_;
  double length_ = 0;
};

/// Unfolds the surface over a glued edge: returns places in the texture beyond one side.
class EdgeCrossing {
 public:
  EdgeCrossing(const SurfaceLayout& layout, const GluedSide& here, const SurfaceFrame& frame,
               const GluedSide& there);
  EdgeCrossing(const SurfaceLayout& layout, const GluedSide& here, const GluedSide& there);

  [[nodiscard]] const EdgeSide& here() const { return here_; }
  /// Returns the place in the texture on the other side.
  [[nodiscard]] cv::Point2d over(const EdgeSide::Place& place) const;
  /// Returns the texel there, or one that is a pixel farther beyond; (−1, −1) where both are outside the
  /// chart.
  [[nodiscard]] cv::Point texel_over(const SurfaceLayout& layout, EdgeSide::Place place) const;

 private:
  EdgeSide here_, there_;
  std::int32_t chart_;  // beyond
};

/// Returns the texel whose centre is nearest.
cv::Point nearest_texel(const cv::Point2d& place);

/// Returns the frame of a side's triangle.
inline const SurfaceFrame& frame_of_side(const SurfaceLayout& layout, const GluedSide& side) {
  return layout.frames[static_cast<std::size_t>(side.triangle)];
}
inline std::int32_t chart_of_side(const SurfaceLayout& layout, const GluedSide& side) {
  return layout.charts[static_cast<std::size_t>(side.triangle)];
}

}  // namespace emberfold::dytex::detail
