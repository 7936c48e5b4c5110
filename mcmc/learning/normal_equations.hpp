// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "mcmc/model/rate_maps.hpp"

namespace emberfold::mcmc::detail {

/// Sums of the normal equations of v·n = s, where a normal n sees the component s of a velocity v.
struct NormalEquations {
  double xx = 0, xy = 0, yy = 0, xs = 0, ys = 0;
  void add(graph::Point n, double s, double weight) {
    xx += weight * n.x * n.x, xy += weight * n.x * n.y, yy += weight * n.y * n.y;
    xs += weight * n.x * s, ys += weight * n.y * s;
  }
  /// Solution that shrinks towards `prior`, which has the precision `precision`.
  [[nodiscard]] graph::Point solve(graph::Point prior, double precision) const {
    const double a = xx + precision, d = yy + precision, p = xs + precision * prior.x,
                 q = ys + precision * prior.y, determinant = a * d - xy * xy;
    return {(d * p - xy * q) / determinant, (a * q - xy * p) / determinant};
  }
};

/// The same by place.
class CellEquations {
 public:
  explicit CellEquations(const CellMap& grid) : sums_{grid, grid, grid, grid, grid} {
    for (CellMap& sum : sums_) std::ranges::fill(sum.values, 0.0);
  }
  void add(graph::Point p, graph::Point n, double s, double weight) {
    NormalEquations one;
    one.add(n, s, weight);
    const auto cell = sums_[0].index(p);
    const std::array<double, 5> parts{one.xx, one.xy, one.yy, one.xs, one.ys};
    for (std::size_t k = 0; k < parts.size(); ++k) sums_[k].values[cell] += parts[k];
  }
  /// Equations of each cell, with those of its neighbours by nearness (SD `reach`, cells).
  [[nodiscard]] std::vector<NormalEquations> spread(double reach) const {
    std::array<std::vector<double>, 5> near;
    for (std::size_t k = 0; k < near.size(); ++k) near[k] = spread_over_cells(sums_[k], reach);
    std::vector<NormalEquations> cells;
    for (std::size_t c = 0; c < near[0].size(); ++c)
      cells.push_back({near[0][c], near[1][c], near[2][c], near[3][c], near[4][c]});
    return cells;
  }

 private:
  std::array<CellMap, 5> sums_;
};

}  // namespace emberfold::mcmc::detail
