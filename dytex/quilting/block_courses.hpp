// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core/types.hpp>

#include "dytex/quilting/blocks.hpp"
#include "dytex/quilting/quilt.hpp"

/// The block that each pixel of a quilt shows at each time. Inner header of quilting.
namespace emberfold::dytex::detail {

/// A block, its place and its source.
struct PlacedBlock {
  cv::Rect place;
  SourcePixel from;  ///< of its upper left corner
};

/// From frame `frame` on a pixel shows block `block`.
struct BlockChange {
  std::int32_t frame = 0, block = -1;
};

/// For each pixel of the output the blocks that it shows, one after the other. Blocks are numbered in the
/// order of `placed`; a block may show beyond its own place, as far as its source extends.
class BlockCourses {
 public:
  /// `shown`: the block of each pixel at all times, row by row.
  BlockCourses(cv::Size size, bool wraps, std::vector<PlacedBlock> placed, std::vector<std::int32_t> shown);

  [[nodiscard]] cv::Size size() const { return size_; }
  [[nodiscard]] bool wraps() const { return wraps_; }
  [[nodiscard]] const std::vector<PlacedBlock>& placed() const { return placed_; }
  /// Returns the source pixel that a block shows, or would show, at an output pixel; it may be outside.
  [[nodiscard]] SourcePixel source_of(std::int32_t block, cv::Point pixel) const;

  /// Writes the block shown at the first frame of each span of time.
  void read(cv::Point pixel, std::span<const int> begins, std::span<std::int32_t> blocks) const;
  /// Replaces a pixel's course by blocks shown from each of `begins` on.
  void write(cv::Point pixel, std::span<const int> begins, std::span<const std::int32_t> blocks);

  [[nodiscard]] QuiltMap map(int frames) const;

 private:
  [[nodiscard]] std::size_t index(cv::Point pixel) const {
    return static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(size_.width) +
           static_cast<std::size_t>(pixel.x);
  }

  cv::Size size_;
  bool wraps_ = false;
  std::vector<PlacedBlock> placed_;
  std::vector<std::int32_t> first_;
  std::vector<std::vector<BlockChange>> later_;
};

}  // namespace emberfold::dytex::detail
