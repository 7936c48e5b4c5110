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

/// The source pixel that each output pixel copies, at all times, row by row. Quilting finds it; rendering
/// needs nothing else.
struct QuiltMap {
  cv::Size size;
  std::vector<SourcePixel> pixels;

  [[nodiscard]] const SourcePixel& at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
                  static_cast<std::size_t>(x)];
  }
  bool operator==(const QuiltMap&) const = default;
};

/// Tells whether two output pixels, neighbours by `step`, are copies of neighbours by the same step: no seam.
[[nodiscard]] inline bool continues(const SourcePixel& a, const SourcePixel& b, cv::Point step) {
  return a.source == b.source && a.x + step.x == b.x && a.y + step.y == b.y;
}

/// Returns the map as an array, height × width × 3, int32: source, x, y.
core::NpyArray to_array(const QuiltMap& map);

/// Reads a map from an array. InputError unless it is one of to_array(), at least 1×1, and every place lies
/// in a source of these sizes.
QuiltMap quilt_map(const core::NpyArray& array, std::span<const cv::Size> sources);

}  // namespace emberfold::dytex
