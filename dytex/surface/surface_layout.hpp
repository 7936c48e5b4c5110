// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core/types.hpp>

#include "dytex/surface/uv_mesh.hpp"

namespace emberfold::dytex {

/// A step of (X, Y) texels is (across · X + shear · Y, down · Y) source pixels along the surface. The
/// surface's x points where the texture's right points, so that nothing is turned within the texture.
struct SurfaceFrame {
  double across = 1, shear = 0, down = 1;
  [[nodiscard]] cv::Point2d to_surface(const cv::Point2d& texels) const {
    return {across * texels.x + shear * texels.y, down * texels.y};
  }
  [[nodiscard]] cv::Point2d to_texels(const cv::Point2d& step) const {
    const double y = step.y / down;
    return {(step.x - shear * y) / across, y};
  }
};

/// One side of an edge at which two charts, or two ends of a chart, meet on the surface.
struct GluedSide {
  std::int32_t triangle = 0;
  cv::Point2d from, to;  ///< px of the texture; the same points of the surface on both sides
};
struct GluedEdge {
  GluedSide a, b;
};

/// A surface as the texels of a texture show it. A chart is a connected part of the texture.
struct SurfaceLayout {
  cv::Size size;                        ///< px, of the texture
  double pixel = 0;                     ///< size of a source pixel on the surface, in the mesh's unit
  std::vector<std::int32_t> triangles;  ///< of each texel, row by row: the one containing its centre, or −1
  std::vector<std::int32_t> charts;     ///< of each triangle, from 0
  std::vector<SurfaceFrame> frames;     ///< of each triangle
  std::vector<cv::Point2d> centres;     ///< of each triangle, px of the texture
  std::vector<GluedEdge> glued;
  int chart_count = 0;
  int hidden_charts = 0;      ///< charts without a texel
  std::int64_t covered = 0;   ///< texels of the surface
  std::int64_t repeated = 0;  ///< further places of the surface that they show

  [[nodiscard]] bool contains(const cv::Point& texel) const { return cv::Rect({}, size).contains(texel); }
  [[nodiscard]] std::size_t index(const cv::Point& texel) const {
    return static_cast<std::size_t>(texel.y) * static_cast<std::size_t>(size.width) +
           static_cast<std::size_t>(texel.x);
  }
  [[nodiscard]] cv::Point texel(std::size_t index) const {
    return {static_cast<int>(index % static_cast<std::size_t>(size.width)),
            static_cast<int>(index / static_cast<std::size_t>(size.width))};
  }
  /// Returns the chart that contains a place in the texture, or −1.
  [[nodiscard]] std::int32_t chart_at(const cv::Point& texel) const {
    const std::int32_t triangle = contains(texel) ? triangles[index(texel)] : -1;
    return triangle < 0 ? -1 : charts[static_cast<std::size_t>(triangle)];
  }
};

/// Lays a texture of `size`, 1 … 16384 px each way, over a surface. `pixel`: the size of a source pixel on
/// the surface, in the mesh's unit; 0: that of a texel in the mean. Where frames would be stretched more than
/// 16 times, they count as stretched 16 times. Throws InputError for a size or pixel beyond that, and where
/// the surface has no area or covers no texel. O(n log n + texels).
SurfaceLayout lay_out_surface(const UvMesh& mesh, cv::Size size, double pixel = 0);

}  // namespace emberfold::dytex
