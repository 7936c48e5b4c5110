// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/patch.hpp"

namespace emberfold::graph::detail {

/// Finds points within a fixed radius by a grid of cells of that size.
class PointGrid {
 public:
  /// `radius`: px, > 0.
  PointGrid(std::vector<Point> points, double radius);

  /// Returns the indices of the points within the radius of `centre`, ascending. O(points near it).
  [[nodiscard]] std::vector<std::uint32_t> find_near(Point centre) const;

 private:
  struct Cell {
    std::int64_t column = 0, row = 0;
    std::uint32_t index = 0;
  };
  std::vector<Point> points_;
  double radius_;
  std::vector<Cell> cells_;  ///< sorted
};

}  // namespace emberfold::graph::detail
