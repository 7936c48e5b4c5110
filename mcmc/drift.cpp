// SPDX-License-Identifier: Apache-2.0
#include "mcmc/drift.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace emberfold::mcmc {

namespace {

constexpr double smallest_cell = 16, most_cells = 48;  // px; along the longer side
constexpr double reach = 2;                            // cells, SD of nearness
constexpr double doubt = 300;                          // steps that the drawing back is worth

// Sums of the normal equations of v·n = s.
struct Normal {
  double xx = 0, xy = 0, yy = 0, xs = 0, ys = 0;
  void add(graph::Point n, double s) {
    xx += n.x * n.x, xy += n.x * n.y, yy += n.y * n.y, xs += n.x * s, ys += n.y * s;
  }
  // The solution drawn towards `prior`, as if `weight` steps in all directions had shown that.
  [[nodiscard]] graph::Point solve(graph::Point prior, double weight) const {
    const double a = xx + weight / 2, d = yy + weight / 2, p = xs + weight / 2 * prior.x,
                 q = ys + weight / 2 * prior.y, determinant = a * d - xy * xy;
    return {(d * p - xy * q) / determinant, (a * q - xy * p) / determinant};
  }
};

// One dimension of spread(): into[i] += share of from[j].
std::vector<double> kernel(double sigma) {
  const int r = static_cast<int>(std::ceil(3 * sigma));
  std::vector<double> weights;
  for (int i = -r; i <= r; ++i) weights.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
  return weights;
}

void spread_line(const std::vector<double>& weights, const double* from, double* into, int count, int stride) {
  const int r = static_cast<int>(weights.size() / 2);
  for (int j = 0; j < count; ++j) {
    const int first = std::max(0, j - r), last = std::min(count - 1, j + r);
    double sum = 0;
    for (int i = first; i <= last; ++i) sum += weights[static_cast<std::size_t>(i - j + r)];
    for (int i = first; i <= last; ++i)
      into[i * stride] += weights[static_cast<std::size_t>(i - j + r)] / sum * from[j * stride];
  }
}

}  // namespace

CellMap grid_over(int width, int height) {
  CellMap map;
  map.cell = std::max(smallest_cell, std::ceil(std::max(width, height) / most_cells));
  map.columns = static_cast<int>(std::ceil(width / map.cell));
  map.rows = static_cast<int>(std::ceil(height / map.cell));
  map.values.assign(static_cast<std::size_t>(map.columns) * static_cast<std::size_t>(map.rows), 0.0);
  return map;
}

std::vector<double> spread(const CellMap& map, double sigma) {
  if (sigma <= 0) return map.values;
  const auto weights = kernel(sigma);
  std::vector<double> across(map.values.size()), both(map.values.size());
  for (int r = 0; r < map.rows; ++r) {
    const auto at = static_cast<std::ptrdiff_t>(r) * map.columns;
    spread_line(weights, map.values.data() + at, across.data() + at, map.columns, 1);
  }
  for (int c = 0; c < map.columns; ++c)
    spread_line(weights, across.data() + c, both.data() + c, map.rows, map.columns);
  return both;
}

Drift measure_drift(const std::vector<detail::Lineage>& all, const CellMap& grid) {
  std::array<CellMap, 5> sums{grid, grid, grid, grid, grid};
  Normal total;
  for (const auto& lineage : all)
    for (std::size_t k = 1; k < lineage.samples.size(); ++k) {
      const auto& before = lineage.samples[k - 1];
      const double s = lineage.samples[k].travel - before.travel;
      Normal one;
      one.add(before.normal, s);
      total.add(before.normal, s);
      const auto cell = grid.index(before.position);
      const std::array<double, 5> parts{one.xx, one.xy, one.yy, one.xs, one.ys};
      for (std::size_t i = 0; i < parts.size(); ++i) sums[i].values[cell] += parts[i];
    }
  const graph::Point mean = total.solve({0, 0}, doubt);
  std::array<std::vector<double>, 5> near;
  for (std::size_t i = 0; i < near.size(); ++i) near[i] = spread(sums[i], reach);
  Drift drift{grid, grid};
  // A spread cell holds a share of what its surroundings do: about one in `area` of them.
  const double area = 4 * std::numbers::pi * reach * reach;
  for (std::size_t i = 0; i < grid.values.size(); ++i) {
    const Normal here{near[0][i], near[1][i], near[2][i], near[3][i], near[4][i]};
    const graph::Point v = here.solve(mean, doubt / area);
    drift.x.values[i] = v.x, drift.y.values[i] = v.y;
  }
  return drift;
}

}  // namespace emberfold::mcmc
