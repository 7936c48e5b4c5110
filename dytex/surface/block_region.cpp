// SPDX-License-Identifier: Apache-2.0
#include "dytex/surface/block_region.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dytex/surface/edge_crossing.hpp"

namespace emberfold::dytex::detail {

namespace {

/// The frame whose squared lengths are the mean of those of some texels.
SurfaceFrame mean_frame(const SurfaceLayout& layout, const BlockRegion& region) {
  double right = 0, mixed = 0, below = 0;
  for (const auto& one : region.texels) {
    const auto triangle = static_cast<std::size_t>(layout.triangles[static_cast<std::size_t>(one.texel)]);
    const SurfaceFrame& f = layout.frames[triangle];
    right += f.across * f.across, mixed += f.across * f.shear, below += f.shear * f.shear + f.down * f.down;
  }
  const auto count = static_cast<double>(region.texels.size());
  right /= count, mixed /= count, below /= count;
  SurfaceFrame mean;
  mean.across = std::sqrt(right);
  mean.shear = mixed / mean.across;
  mean.down = std::sqrt(std::max(below - mean.shear * mean.shear, 1e-6));
  return mean;
}

}  // namespace

void RegionFinder::flood(BlockRegion& region) {
  ++mark_;
  region.texels.clear();
  std::vector<cv::Point> open;
  const auto visit = [&](const cv::Point& texel) {
    if (layout_.chart_at(texel) != region.chart) return;
    const std::size_t index = layout_.index(texel);
    if (marks_[index] == mark_) return;
    const std::int32_t cell = region.cell_index(nearest_texel(region.cell_of(texel)));
    if (cell < 0) return;
    marks_[index] = mark_;
    region.texels.push_back({static_cast<std::int32_t>(index), cell});
    open.push_back(texel);
  };
  visit(nearest_texel(region.seed));
  while (!open.empty()) {
    const cv::Point at = open.back();
    open.pop_back();
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) visit(at + cv::Point(x, y));
  }
}

void RegionFinder::find_nearest(BlockRegion& region) const {
  region.nearest.assign(static_cast<std::size_t>(region.block.area()), -1);
  for (int y = 0; y < region.block.height; ++y)
    for (int x = 0; x < region.block.width; ++x) {
      const cv::Point texel = nearest_texel(region.texel_of(cv::Point(x, y)));
      if (layout_.contains(texel) && marks_[layout_.index(texel)] == mark_)
        region.nearest[static_cast<std::size_t>(region.cell_index({x, y}))] =
            static_cast<std::int32_t>(layout_.index(texel));
    }
}

void RegionFinder::find_rim(BlockRegion& region) const {
  const auto look_around = [&](std::int32_t texel, std::int32_t cell) {
    for (const cv::Point step : {cv::Point(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
      const cv::Point beside = layout_.texel(static_cast<std::size_t>(texel)) + step;
      if (layout_.chart_at(beside) == region.chart && marks_[layout_.index(beside)] != mark_)
        region.rim.push_back({static_cast<std::int32_t>(layout_.index(beside)), cell});
    }
  };
  for (const auto& [texel, cell] : region.texels) look_around(texel, cell);
  for (std::size_t i = 0; i < region.nearest.size(); ++i)
    if (region.nearest[i] >= 0) look_around(region.nearest[i], static_cast<std::int32_t>(i));
}

BlockRegion RegionFinder::find(std::int32_t seed, const cv::Point& seed_cell, cv::Size block) {
  const auto triangle = static_cast<std::size_t>(layout_.triangles[static_cast<std::size_t>(seed)]);
  BlockRegion region;
  region.block = block;
  region.frame = layout_.frames[triangle];
  region.seed = layout_.texel(static_cast<std::size_t>(seed));
  region.seed_cell = seed_cell;
  region.chart = layout_.charts[triangle];
  flood(region);
  region.frame = mean_frame(layout_, region);
  flood(region);
  find_nearest(region);
  find_rim(region);
  return region;
}

GluedNeighbours::GluedNeighbours(const SurfaceLayout& layout)
    : layout_(layout), edges_(static_cast<std::size_t>(layout.chart_count)) {
  for (const auto& [a, b] : layout.glued) {
    edges_[static_cast<std::size_t>(chart_of_side(layout, a))].emplace_back(a, b);
    edges_[static_cast<std::size_t>(chart_of_side(layout, b))].emplace_back(b, a);
  }
}

std::vector<std::int32_t> GluedNeighbours::texels_beyond(const BlockRegion& region, int reach) const {
  std::vector<std::int32_t> texels(region.nearest.size(), -1);
  std::vector<double> distance(texels.size(), std::numeric_limits<double>::max());
  const auto of_region = [&](const cv::Point2d& place) {
    const std::int32_t cell = region.cell_index(nearest_texel(region.cell_of(place)));
    return cell >= 0 && region.nearest[static_cast<std::size_t>(cell)] >= 0;
  };
  for (const auto& [own, other] : edges_[static_cast<std::size_t>(region.chart)]) {
    const cv::Point2d p = region.cell_of(own.from), q = region.cell_of(own.to);
    const auto begin = [&](double a, double b) {
      return std::max(0, static_cast<int>(std::floor(std::min(a, b))) - reach);
    };
    const auto end = [&](double a, double b, int size) {
      return std::min(size - 1, static_cast<int>(std::ceil(std::max(a, b))) + reach);
    };
    const int bottom = end(p.y, q.y, region.block.height), right = end(p.x, q.x, region.block.width);
    if (begin(p.x, q.x) > right || begin(p.y, q.y) > bottom) continue;
    const EdgeCrossing crossing(layout_, own, region.frame, other);
    for (int y = begin(p.y, q.y); y <= bottom; ++y)
      for (int x = begin(p.x, q.x); x <= right; ++x) {
        const auto cell = static_cast<std::size_t>(region.cell_index({x, y}));
        if (region.nearest[cell] >= 0) continue;
        const auto place = crossing.here().place(region.texel_of(cv::Point(x, y)));
        if (place.along < -0.5 || place.along > crossing.here().length() + 0.5 || place.beyond <= -0.5 ||
            place.beyond > reach || place.beyond >= distance[cell])
          continue;
        if (!of_region(crossing.here().texel({place.along, -1}))) continue;
        const cv::Point texel = crossing.texel_over(layout_, place);
        if (texel.x < 0) continue;
        distance[cell] = place.beyond;
        texels[cell] = static_cast<std::int32_t>(layout_.index(texel));
      }
  }
  return texels;
}

}  // namespace emberfold::dytex::detail
