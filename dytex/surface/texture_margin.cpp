// SPDX-License-Identifier: Apache-2.0
#include "dytex/surface/texture_margin.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dytex/surface/edge_crossing.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr double kMargin = 8;      // texels beyond glued edges that continue the surface
constexpr double kEdgePiece = 16;  // texels, of an edge processed together

/// A texel beyond a glued edge, how far away, and the one that it shows.
struct BeyondEdge {
  double distance = 0;
  std::size_t shows = 0;
};
using MarginTexels = std::unordered_map<std::size_t, BeyondEdge>;

void look_beyond(const SurfaceLayout& layout, const GluedSide& own, const GluedSide& other,
                 MarginTexels& margin) {
  const EdgeCrossing crossing(layout, own, other);
  const cv::Point2d edge = own.to - own.from;
  const double length = std::hypot(edge.x, edge.y);
  const int pieces = std::max(1, static_cast<int>(std::ceil(length / kEdgePiece)));
  for (int piece = 0; piece < pieces; ++piece) {
    const cv::Point2d p = own.from + edge * (static_cast<double>(piece) / pieces),
                      q = own.from + edge * (static_cast<double>(piece + 1) / pieces);
    const cv::Point low = nearest_texel({std::min(p.x, q.x) - kMargin, std::min(p.y, q.y) - kMargin}),
                    high = nearest_texel({std::max(p.x, q.x) + kMargin, std::max(p.y, q.y) + kMargin});
    for (int y = std::max(0, low.y); y <= std::min(layout.size.height - 1, high.y); ++y)
      for (int x = std::max(0, low.x); x <= std::min(layout.size.width - 1, high.x); ++x) {
        const std::size_t index = layout.index({x, y});
        if (layout.triangles[index] >= 0) continue;
        const cv::Point2d at(x, y);
        const auto place = crossing.here().place(at);
        const double along = std::clamp(place.along, 0.0, crossing.here().length());
        const cv::Point2d way = at - crossing.here().texel({along, 0});
        const double distance = std::hypot(way.x, way.y);
        const auto known = margin.find(index);
        if (place.beyond < 0 || distance > kMargin ||
            (known != margin.end() && known->second.distance <= distance))
          continue;
        const cv::Point texel = crossing.texel_over(layout, {along, place.beyond});
        if (texel.x >= 0) margin[index] = {distance, layout.index(texel)};
      }
  }
}

// Gives every texel of no chart the pixel of the nearest texel of a chart.
void spread_charts(const SurfaceLayout& layout, QuiltMap& map) {
  cv::Mat empty(layout.size, CV_8U), distance, labels;
  for (int y = 0; y < empty.rows; ++y)
    for (int x = 0; x < empty.cols; ++x)
      empty.at<unsigned char>(y, x) = layout.triangles[layout.index({x, y})] < 0 ? 1 : 0;
  if (layout.covered == static_cast<std::int64_t>(empty.total())) return;
  cv::distanceTransform(empty, distance, labels, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::vector<std::size_t> texel(static_cast<std::size_t>(layout.covered) + 1);
  for (int y = 0; y < empty.rows; ++y)
    for (int x = 0; x < empty.cols; ++x)
      if (empty.at<unsigned char>(y, x) == 0)
        texel[static_cast<std::size_t>(labels.at<int>(y, x))] = layout.index({x, y});
  for (int y = 0; y < empty.rows; ++y)
    for (int x = 0; x < empty.cols; ++x)
      if (empty.at<unsigned char>(y, x) != 0)
        map.pixels[layout.index({x, y})] = map.pixels[texel[static_cast<std::size_t>(labels.at<int>(y, x))]];
}

}  // namespace

void fill_margin(const SurfaceLayout& layout, QuiltMap& map) {
  spread_charts(layout, map);
  MarginTexels margin;
  for (const auto& [a, b] : layout.glued) {
    look_beyond(layout, a, b, margin);
    look_beyond(layout, b, a, margin);
  }
  for (const auto& [texel, beyond] : margin) map.pixels[texel] = map.pixels[beyond.shows];
}

}  // namespace emberfold::dytex::detail
