// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/drift.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mcmc/learning/normal_equations.hpp"

namespace emberfold::mcmc {

namespace {

constexpr double reach = 2;                // cells, SD of nearness
constexpr std::size_t kShortestMoved = 5;  // frames: shorter tracks give no speed
constexpr double least_scatter = 0.01;     // px²
constexpr double usual_drift = 0.5;        // px a frame, SD of drifts of the prior
constexpr double kTracksAlike = 8;         // neighbouring tracks that count as one observation

// A speed that is not clearly above its own error counts as 0; else resting strokes would creep away in a
// long clip.
graph::Point shrink_insignificant(graph::Point v, const detail::NormalEquations& seen, double precision,
                                  double area) {
  const double square = graph::dot(v, v);
  if (square <= 0) return v;
  const double a = seen.xx + precision, d = seen.yy + precision;
  const double along = d * v.x * v.x - 2 * seen.xy * v.x * v.y + a * v.y * v.y;
  const double error = along / square / (a * d - seen.xy * seen.xy) / area;  // variance in the direction of v
  return v * std::max(0.0, 1 - 4 * error / square);
}

// A track's mean speed along its normals, and the scatter of its travel about a steady one.
struct SpeedFit {
  double speed = 0, scatter = 0;
};
SpeedFit fit_speed(const detail::CurveTrack& track) {
  const auto n = static_cast<double>(track.samples.size());
  double mean = 0, slope = 0, square = 0;
  for (std::size_t k = 0; k < track.samples.size(); ++k) mean += track.samples[k].normal_displacement / n;
  for (std::size_t k = 0; k < track.samples.size(); ++k) {
    const double time = static_cast<double>(k) - (n - 1) / 2, d = track.samples[k].normal_displacement - mean;
    slope += d * time / (n * (n * n - 1) / 12);
    square += d * d / n;
  }
  return {slope, std::max(0.0, square - slope * slope * (n * n - 1) / 12)};
}

}  // namespace

Drift estimate_drift(const std::vector<detail::CurveTrack>& all, const CellMap& grid) {
  std::vector<SpeedFit> speeds;
  double scatter = 0, samples = 0;
  for (const auto& track : all) {
    speeds.push_back(track.samples.size() >= kShortestMoved ? fit_speed(track) : SpeedFit{});
    if (track.samples.size() < kShortestMoved) continue;
    scatter += speeds.back().scatter * static_cast<double>(track.samples.size());
    samples += static_cast<double>(track.samples.size());
  }
  scatter = samples > 0 ? std::max(scatter / samples, least_scatter) : 1;

  detail::CellEquations cells(grid);
  detail::NormalEquations total;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto n = static_cast<double>(all[i].samples.size());
    if (all[i].samples.size() < kShortestMoved) continue;
    // A mean speed over n frames has an error of about √(2 scatter) / n px from displacements of this
    // variance.
    const double weight = n * n / (2 * scatter) / kTracksAlike / n;
    for (const auto& sample : all[i].samples) {
      cells.add(sample.position, sample.normal, speeds[i].speed, weight);
      total.add(sample.normal, speeds[i].speed, weight);
    }
  }
  constexpr double precision = 1 / (usual_drift * usual_drift);
  const graph::Point mean = total.solve({0, 0}, precision);
  const auto near = cells.spread(reach);
  Drift drift{grid, grid};
  // A cell holds about one part in `area` of the observations around it.
  const double area = 4 * std::numbers::pi * reach * reach;
  for (std::size_t i = 0; i < grid.values.size(); ++i) {
    const graph::Point v =
        shrink_insignificant(near[i].solve(mean, precision / area), near[i], precision / area, area);
    drift.x.values[i] = v.x, drift.y.values[i] = v.y;
  }
  return drift;
}

std::vector<double> without_drift(const detail::CurveTrack& track, const CellMap& drift_x,
                                  const CellMap& drift_y) {
  std::vector<double> displacement;
  double drifted = 0;
  for (const auto& sample : track.samples) {
    displacement.push_back(sample.normal_displacement - drifted);
    drifted += graph::dot({drift_x.at(sample.position), drift_y.at(sample.position)}, sample.normal);
  }
  return displacement;
}

}  // namespace emberfold::mcmc
