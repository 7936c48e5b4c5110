// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/point_grid.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace emberfold::graph::detail {

namespace {
std::int64_t cell_of(double x, double radius) {
  constexpr double kEnd = 4e18;  // within std::int64_t, with room for one more
  return static_cast<std::int64_t>(std::clamp(std::floor(x / radius), -kEnd, kEnd));
}
}  // namespace

PointGrid::PointGrid(std::vector<Point> points, double radius) : points_(std::move(points)), radius_(radius) {
  for (std::uint32_t k = 0; k < points_.size(); ++k) {
    cells_.push_back({cell_of(points_[k].x, radius), cell_of(points_[k].y, radius), k});
  }
  std::sort(cells_.begin(), cells_.end(), [](const Cell& a, const Cell& b) {
    return std::tie(a.column, a.row, a.index) < std::tie(b.column, b.row, b.index);
  });
}

std::vector<std::uint32_t> PointGrid::find_near(Point centre) const {
  std::vector<std::uint32_t> result;
  const std::int64_t column = cell_of(centre.x, radius_), row = cell_of(centre.y, radius_);
  for (std::int64_t c = column - 1; c <= column + 1; ++c) {
    const auto key = std::pair(c, row - 1);
    auto at = std::lower_bound(cells_.begin(), cells_.end(), key, [](const Cell& cell, const auto& wanted) {
      return std::pair(cell.column, cell.row) < wanted;
    });
    for (; at != cells_.end() && at->column == c && at->row <= row + 1; ++at) {
      const Point apart = points_[at->index] - centre;
      if (dot(apart, apart) <= radius_ * radius_) result.push_back(at->index);
    }
  }
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace emberfold::graph::detail
