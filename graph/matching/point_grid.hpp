// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/patch.hpp"

namespace emberfold::graph::detail {

/// Finds points within a fixed radius.
class Near {
 public:
  Near(std::vector<Point> points, double radius);

  /// The points within the radius of `centre`, ascending by index.
  [[nodiscard]] std::vector<std::uint32_t> around(Point centre) const;

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
