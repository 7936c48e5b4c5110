// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core/types.hpp>

#include "core/npy.hpp"

namespace emberfold::dytex {

/// A place in the sources of a quilt: which source, from 0, and the pixel in it. All −1: nowhere yet.
struct SourcePixel {
  std::int32_t source = -1, x = -1, y = -1;
  bool operator==(const SourcePixel&) const = default;
};

/// From source frame `frame` on an output pixel copies `from`.
struct SourceChange {
  std::int32_t frame = 0;
  SourcePixel from;
  bool operator==(const SourceChange&) const = default;
};

/// The source pixel that each output pixel copies, row by row. Quilting finds it; rendering needs nothing
/// else. Where seams move, the copied pixel changes with the frame of the source.
struct QuiltMap {
  cv::Size size;
  std::vector<SourcePixel> pixels;  ///< from frame 0 on
  /// The changes of all pixels, one pixel after the other, of each in the order of frames ≥ 1. Of pixel i
  /// they end at change_ends[i], where those of pixel i + 1 begin; both are empty where seams stand still.
  std::vector<SourceChange> changes{};
  std::vector<std::size_t> change_ends{};
  int frames = 0;  ///< of the source that the changes belong to; 0 without

  [[nodiscard]] bool is_still() const { return change_ends.empty(); }
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) + static_cast<std::size_t>(x);
  }
  [[nodiscard]] const SourcePixel& at(int x, int y) const { return pixels[index(x, y)]; }
  /// Returns the changes of a pixel.
  [[nodiscard]] std::span<const SourceChange> changes_of(std::size_t pixel) const;
  /// Returns the pixel copied from the source's frame `frame`. O(log of its changes).
  [[nodiscard]] const SourcePixel& at_frame(std::size_t pixel, int frame) const;
  bool operator==(const QuiltMap&) const = default;
};

/// Returns whether two output pixels, neighbours by `step`, copy neighbours by the same step: no seam.
[[nodiscard]] inline bool continues(const SourcePixel& a, const SourcePixel& b, cv::Point step) {
  return a.source == b.source && a.x + step.x == b.x && a.y + step.y == b.y;
}

/// Returns the map of one frame as a map whose seams stand still.
QuiltMap still_at(const QuiltMap& map, int frame);

/// Returns the map as an int32 array. Version 1, of a map whose seams stand still: height × width × 3
/// (source, x, y). Version 2: rows × 6 (t, y, x, source, x, y), for each pixel one row for frame 0 and one
/// for each change, ordered by y, x and t, after a first row of frames, height, width, 2, 0, 0.
core::NpyArray to_array(const QuiltMap& map);

/// Reads a map of either version from an array. Throws InputError unless it is one of to_array(), at least
/// 1×1, and every place is inside a source of these sizes.
QuiltMap quilt_map(const core::NpyArray& array, std::span<const cv::Size> sources);

}  // namespace emberfold::dytex
