// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/drift.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace emberfold::mcmc {

namespace {

constexpr double smallest_cell = 16, most_cells = 48;  // px; along the longer side
constexpr double reach = 2;                            // cells, SD of nearness
constexpr std::size_t shortest = 5;                    // frames: shorter lineages tell no speed
constexpr double least_scatter = 0.01;                 // px²
constexpr double usual_drift = 0.5;                    // px a frame, SD of drifts before anything is seen
constexpr double alike = 8;                            // neighbouring lineages that say about the same

// Sums of the normal equations of v·n = s.
struct Normal {
  double xx = 0, xy = 0, yy = 0, xs = 0, ys = 0;
  void add(graph::Point n, double s, double weight) {
    xx += weight * n.x * n.x, xy += weight * n.x * n.y, yy += weight * n.y * n.y;
    xs += weight * n.x * s, ys += weight * n.y * s;
  }
  // The solution drawn towards `prior`, of which it is known to `precision`.
  [[nodiscard]] graph::Point solve(graph::Point prior, double precision) const {
    const double a = xx + precision, d = yy + precision, p = xs + precision * prior.x,
                 q = ys + precision * prior.y, determinant = a * d - xy * xy;
    return {(d * p - xy * q) / determinant, (a * q - xy * p) / determinant};
  }
};

// A speed that is not clearly above its own error is none: else what stands would creep away in a long clip.
graph::Point told_apart(graph::Point v, const Normal& seen, double precision, double area) {
  const double square = graph::dot(v, v);
  if (square <= 0) return v;
  const double a = seen.xx + precision, d = seen.yy + precision;
  const double along = d * v.x * v.x - 2 * seen.xy * v.x * v.y + a * v.y * v.y;
  const double error = along / square / (a * d - seen.xy * seen.xy) / area;  // variance in the direction of v
  return v * std::max(0.0, 1 - 4 * error / square);
}

// A lineage's mean speed along its normals and how its travel scatters about a steady one.
struct Course {
  double speed = 0, scatter = 0;
};
Course course(const detail::Lineage& lineage) {
  const auto n = static_cast<double>(lineage.samples.size());
  double mean = 0, slope = 0, square = 0;
  for (std::size_t k = 0; k < lineage.samples.size(); ++k) mean += lineage.samples[k].travel / n;
  for (std::size_t k = 0; k < lineage.samples.size(); ++k) {
    const double time = static_cast<double>(k) - (n - 1) / 2, d = lineage.samples[k].travel - mean;
    slope += d * time / (n * (n * n - 1) / 12);
    square += d * d / n;
  }
  return {slope, std::max(0.0, square - slope * slope * (n * n - 1) / 12)};
}

// One dimension of spread(): into[i] += share of from[j].
std::vector<double> kernel(double sigma) {
  const int r = static_cast<int>(std::ceil(3 * sigma));
  std::vector<double> weights;
  for (int i = -r; i <= r; ++i) weights.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
  return weights;
}

void spread_line(const std::vector<double>& weights, const double* from, double* into, int count,
                 int stride) {
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
  std::vector<Course> courses;
  double scatter = 0, samples = 0;
  for (const auto& lineage : all) {
    courses.push_back(lineage.samples.size() >= shortest ? course(lineage) : Course{});
    if (lineage.samples.size() < shortest) continue;
    scatter += courses.back().scatter * static_cast<double>(lineage.samples.size());
    samples += static_cast<double>(lineage.samples.size());
  }
  scatter = samples > 0 ? std::max(scatter / samples, least_scatter) : 1;

  std::array<CellMap, 5> sums{grid, grid, grid, grid, grid};
  Normal total;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto n = static_cast<double>(all[i].samples.size());
    if (all[i].samples.size() < shortest) continue;
    // A sway of this scatter lets a mean speed over n frames be off by about √(2 scatter) / n.
    const double weight = n * n / (2 * scatter) / alike / n;
    for (const auto& sample : all[i].samples) {
      Normal one;
      one.add(sample.normal, courses[i].speed, weight);
      total.add(sample.normal, courses[i].speed, weight);
      const auto cell = grid.index(sample.position);
      const std::array<double, 5> parts{one.xx, one.xy, one.yy, one.xs, one.ys};
      for (std::size_t k = 0; k < parts.size(); ++k) sums[k].values[cell] += parts[k];
    }
  }
  constexpr double precision = 1 / (usual_drift * usual_drift);
  const graph::Point mean = total.solve({0, 0}, precision);
  std::array<std::vector<double>, 5> near;
  for (std::size_t i = 0; i < near.size(); ++i) near[i] = spread(sums[i], reach);
  Drift drift{grid, grid};
  // A cell holds about one part in `area` of what is seen around it.
  const double area = 4 * std::numbers::pi * reach * reach;
  for (std::size_t i = 0; i < grid.values.size(); ++i) {
    const Normal here{near[0][i], near[1][i], near[2][i], near[3][i], near[4][i]};
    const graph::Point v = told_apart(here.solve(mean, precision / area), here, precision / area, area);
    drift.x.values[i] = v.x, drift.y.values[i] = v.y;
  }
  return drift;
}

}  // namespace emberfold::mcmc
