// SPDX-License-Identifier: Apache-2.0
#include "mcmc/model/rate_maps.hpp"

#include <algorithm>
#include <cmath>

namespace emberfold::mcmc {

namespace {

constexpr double smallest_cell = 16;  // px: finer maps would hold few events a cell
constexpr double most_cells = 48;     // along the longer side: bounds the cost in large frames
constexpr double kernel_reach = 3;    // SDs up to which a Gaussian is summed; the rest is 0.3 % of it

// Returns the weights of a Gaussian of SD sigma up to 3 SDs on each side.
std::vector<double> kernel(double sigma) {
  const int r = static_cast<int>(std::ceil(kernel_reach * sigma));
  std::vector<double> weights;
  for (int i = -r; i <= r; ++i) weights.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
  return weights;
}

// Distributes each value of a line over the line: into[i] += share of from[j].
void spread_line(const std::vector<double>& weights, const double* from, double* into, int count,
                 int stride) {
  const int r = static_cast<int>(weights.size() / 2);
  const double* of_distance = weights.data() + r;
  for (int j = 0; j < count; ++j) {
    const int first = std::max(0, j - r), last = std::min(count - 1, j + r);
    double sum = 0;
    for (int i = first; i <= last; ++i) sum += of_distance[i - j];
    for (int i = first; i <= last; ++i) into[i * stride] += of_distance[i - j] / sum * from[j * stride];
  }
}

}  // namespace

std::size_t CellMap::index(graph::Point p) const {
  const auto place = [&](double x, int count) {
    return static_cast<std::size_t>(std::clamp(std::floor((x + 0.5) / cell), 0.0, count - 1.0));
  };
  return place(p.y, rows) * static_cast<std::size_t>(columns) + place(p.x, columns);
}

CellMap make_cell_grid(int width, int height) {
  CellMap map;
  map.cell = std::max(smallest_cell, std::ceil(std::max(width, height) / most_cells));
  map.columns = static_cast<int>(std::ceil(width / map.cell));
  map.rows = static_cast<int>(std::ceil(height / map.cell));
  map.values.assign(static_cast<std::size_t>(map.columns) * static_cast<std::size_t>(map.rows), 0.0);
  return map;
}

std::vector<double> spread_over_cells(const CellMap& map, double sigma) {
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

graph::Point draw_place(const CellMap& map, core::Rng& rng) {
  const auto cell = rng.categorical(map.values);
  const auto columns = static_cast<std::size_t>(map.columns);
  const std::size_t column = cell % columns, row = cell / columns;
  const double x = rng.uniform(), y = rng.uniform();
  return {(static_cast<double>(column) + x) * map.cell - 0.5,
          (static_cast<double>(row) + y) * map.cell - 0.5};
}

double interpolate(const CellMap& map, graph::Point p) {
  const double x = (p.x + 0.5) / map.cell - 0.5, y = (p.y + 0.5) / map.cell - 0.5;
  const double u = x - std::floor(x), v = y - std::floor(y);
  const auto value = [&](double dx, double dy) {
    return map.at({(std::floor(x) + dx + 0.5) * map.cell - 0.5, (std::floor(y) + dy + 0.5) * map.cell - 0.5});
  };
  return (1 - v) * ((1 - u) * value(0, 0) + u * value(1, 0)) + v * ((1 - u) * value(0, 1) + u * value(1, 1));
}

}  // namespace emberfold::mcmc
