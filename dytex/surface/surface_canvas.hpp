// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dytex/quilting/quilt.hpp"
#include "dytex/quilting/search.hpp"
#include "dytex/surface/block_cut.hpp"
#include "dytex/surface/block_region.hpp"

/// A texture of a surface while it grows. Inner header of surfaces.
namespace emberfold::dytex::detail {

class SurfaceCanvas {
 public:
  /// All have to outlive it.
  SurfaceCanvas(const SurfaceLayout& layout, std::span<const QuiltSource> sources,
                const QuiltOptions& options);

  /// Returns the place of the next block: around the first empty texel, of the largest chart that has one,
  /// which lies `overlap` from the block's top, and as far from that of its sides where the block fills more.
  /// Nothing where none is empty.
  [[nodiscard]] std::optional<BlockRegion> next();
  /// Returns what a block there meets: in its chart, and beyond glued edges.
  [[nodiscard]] BlockQuery query(const BlockRegion& region) const;
  /// Lays a block from `at`. `errors`: of what it meets, CV_64F of the block's size.
  void put(const BlockRegion& region, const SourcePixel& at, const cv::Mat& errors);

  /// Returns the share of the texels that are no longer empty.
  [[nodiscard]] double share() const {
    return static_cast<double>(filled_) / static_cast<double>(layout_.covered);
  }
  [[nodiscard]] QuiltMap take_map() { return {layout_.size, std::move(pixels_)}; }
  [[nodiscard]] std::vector<std::int32_t> take_blocks() { return std::move(blocks_); }

 private:
  struct Placed {
    SourcePixel corner;
    std::vector<std::int32_t> touching;  // earlier blocks that it met
  };
  /// What a cell meets: a source pixel and the block that it is of.
  struct Met {
    SourcePixel from;
    std::int32_t block = -1;
  };
  [[nodiscard]] bool is_filled(std::int32_t texel) const {
    return texel >= 0 && blocks_[static_cast<std::size_t>(texel)] >= 0;
  }
  [[nodiscard]] std::vector<Met> meet(const BlockRegion& region) const;
  [[nodiscard]] SourcePixel shown(const BlockRegion& region, std::int32_t cell) const;
  [[nodiscard]] std::vector<SourcePixel> places_near(const BlockRegion& region,
                                                     const std::vector<Met>& met) const;
  [[nodiscard]] std::int64_t empty_texels(const BlockRegion& region) const;
  [[nodiscard]] CellState state(const BlockRegion& region, std::int32_t cell) const;

  const SurfaceLayout& layout_;
  std::span<const QuiltSource> sources_;
  const QuiltOptions& options_;
  RegionFinder finder_;
  GluedNeighbours neighbours_;
  std::vector<std::int32_t> order_;  // texels, chart after chart
  std::size_t next_ = 0;
  std::int64_t filled_ = 0;
  std::vector<SourcePixel> pixels_;
  std::vector<std::int32_t> blocks_;
  std::vector<Placed> placed_;
};

}  // namespace emberfold::dytex::detail
