// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dytex/quilting/quilt.hpp"
#include "dytex/quilting/search.hpp"
#include "dytex/surface/block_cut.hpp"
#include "dytex/surface/block_region.hpp"

/// A texture of a surface during quilting. Inner header of surfaces.
namespace emberfold::dytex::detail {

/// The place of a block, or of a smaller one that joins a chart's border to the surface beyond.
struct SurfacePlace {
  BlockRegion region;
  bool at_border = false;
};

/// Returns the size of a block that joins borders.
inline cv::Size joint_size(cv::Size block) {
  return {std::max(2, block.width / 2), std::max(2, block.height / 2)};
}

class SurfaceCanvas {
 public:
  /// All must outlive it.
  SurfaceCanvas(const SurfaceLayout& layout, std::span<const QuiltSource> sources,
                const QuiltOptions& options);

  /// Returns the place of the next block: around the first empty texel, of the largest chart that has one,
  /// `overlap` from the block's top and from the side where the block fills more. Where none is
  /// empty, places of half that size along glued edges follow, then nothing.
  [[nodiscard]] std::optional<SurfacePlace> next();
  /// Returns the surroundings that a block there has to fit: all that it meets in its chart and beyond glued
  /// edges; at a border, of its own chart only the rim around it.
  [[nodiscard]] BlockQuery query(const SurfacePlace& place) const;
  /// Lays a block from `at`, joined along the cheapest seams; at a border only where that makes it fit
  /// better.
  void put(const SurfacePlace& place, const SourcePixel& at);

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
  /// A cell's contact: a source pixel and the block that it is of.
  struct Met {
    SourcePixel from;
    std::int32_t block = -1;
    bool beyond = false;
  };
  /// A piece of a glued edge that is to be joined, from its own side.
  struct Joint {
    GluedSide own, other;
    double along = 0;  // source pixels
  };
  [[nodiscard]] bool is_filled(std::int32_t texel) const {
    return texel >= 0 && blocks_[static_cast<std::size_t>(texel)] >= 0;
  }
  [[nodiscard]] std::vector<Met> meet(const BlockRegion& region) const;
  [[nodiscard]] SourcePixel shown(const BlockRegion& region, std::int32_t cell) const;
  [[nodiscard]] std::vector<SourcePixel> places_near(const BlockRegion& region,
                                                     const std::vector<Met>& met) const;
  [[nodiscard]] BlockQuery query_of(const BlockRegion& region, const std::vector<Met>& met) const;
  [[nodiscard]] std::vector<BorderCost> border_costs(const BlockRegion& region, const std::vector<Met>& met,
                                                     std::span<const double> errors) const;
  void find_joints();
  [[nodiscard]] std::optional<BlockRegion> region_at(const Joint& joint);
  [[nodiscard]] std::optional<SurfacePlace> next_joint();
  [[nodiscard]] std::int64_t empty_texels(const BlockRegion& region) const;
  [[nodiscard]] std::vector<CellState> states(const BlockRegion& region) const;

  const SurfaceLayout& layout_;
  std::span<const QuiltSource> sources_;
  const QuiltOptions& options_;
  std::vector<const Trajectories*> courses_;
  RegionFinder finder_;
  GluedNeighbours neighbours_;
  std::vector<std::int32_t> order_;  // texels, chart after chart
  std::size_t next_ = 0;
  std::int64_t filled_ = 0;
  std::vector<SourcePixel> pixels_;
  std::vector<std::int32_t> blocks_;
  std::vector<Placed> placed_;
  std::vector<Joint> joints_;
  std::size_t next_joint_ = 0;
  bool joins_ = false;  // no texel is empty
};

}  // namespace emberfold::dytex::detail
