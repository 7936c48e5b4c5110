// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <opencv2/core/types.hpp>

#include "dytex/surface/surface_layout.hpp"

/// The part of a surface that a block covers. Inner header of surfaces.
namespace emberfold::dytex::detail {

/// A block laid flat around one of its texels. Its cells are its pixels, source pixels on the surface.
struct BlockRegion {
  struct Texel {
    std::int32_t texel = 0, cell = 0;
  };

  cv::Size block;
  SurfaceFrame frame;
  cv::Point2d seed, seed_cell;  ///< a texel, and the cell that it is in
  std::int32_t chart = 0;
  std::vector<Texel> texels;  ///< of the chart, connected within the block
  std::vector<Texel> rim;     ///< texels of the chart adjacent to the region, and the cells that they adjoin
  std::vector<std::int32_t> nearest;  ///< of each cell: the region's texel nearest to its middle, or −1

  [[nodiscard]] cv::Point2d cell_of(const cv::Point2d& texel) const {
    return seed_cell + frame.to_surface(texel - seed);
  }
  [[nodiscard]] cv::Point2d texel_of(const cv::Point2d& cell) const {
    return seed + frame.to_texels(cell - seed_cell);
  }
  /// Returns the index of a cell, or −1 outside of the block.
  [[nodiscard]] std::int32_t cell_index(const cv::Point& cell) const {
    return cv::Rect({}, block).contains(cell) ? cell.y * block.width + cell.x : -1;
  }
  [[nodiscard]] cv::Point cell(std::int32_t index) const {
    return {index % block.width, index / block.width};
  }
};

class RegionFinder {
 public:
  /// The layout must outlive it.
  explicit RegionFinder(const SurfaceLayout& layout) : layout_(layout), marks_(layout.triangles.size()) {}

  /// Finds the part of a chart around a texel that a block covers if this texel is in `seed_cell`, using the
  /// part's mean frame. O(texels of the part + cells).
  BlockRegion find(std::int32_t seed, const cv::Point& seed_cell, cv::Size block);

 private:
  void flood(BlockRegion& region);
  void find_nearest(BlockRegion& region) const;
  void find_rim(BlockRegion& region) const;

  const SurfaceLayout& layout_;
  std::vector<std::uint32_t> marks_;  // the last part that a texel was in
  std::uint32_t mark_ = 0;
};

/// Finds texels beyond glued edges.
class GluedNeighbours {
 public:
  /// The layout must outlive it.
  explicit GluedNeighbours(const SurfaceLayout& layout);

  /// Returns for each cell of a block, up to `reach` beyond a glued edge of its region, the texel that is
  /// there on the surface; −1 elsewhere.
  [[nodiscard]] std::vector<std::int32_t> texels_beyond(const BlockRegion& region, int reach) const;

 private:
  const SurfaceLayout& layout_;
  std::vector<std::vector<std::pair<GluedSide, GluedSide>>> edges_;  // of a chart: its own side first
};

}  // namespace emberfold::dytex::detail
