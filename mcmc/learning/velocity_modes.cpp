// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/velocity_modes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

#include "mcmc/learning/normal_equations.hpp"

namespace emberfold::mcmc {

namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kFieldReach = 1;     // cells, SD of nearness: 1.5 explains less of real clips' steps
constexpr double kPriorTracks = 0.5;  // that the prior of no velocity counts for: made clips keep their steps
constexpr Eigen::Index kMostModes = 20;  // modes: 40 explain .02 to .05 more of a real flag, fire and river
constexpr Eigen::Index kFramesForMode = 4;
constexpr std::size_t kFewestFields = 8;
constexpr double kShareHeld = 0.95;  // of the energy
constexpr double kLeastLeft = 0.1;   // of the steps' variance, that the sway leaves over
constexpr double kJitter = 1e-9;     // keeps the noise's covariance definite

// One field by column: x and y of each cell.
Matrix stacked(const std::vector<Drift>& fields) {
  const auto cells = static_cast<Eigen::Index>(fields.front().x.values.size());
  Matrix all(2 * cells, static_cast<Eigen::Index>(fields.size()));
  for (Eigen::Index t = 0; t < all.cols(); ++t) {
    const Drift& field = fields[static_cast<std::size_t>(t)];
    for (Eigen::Index c = 0; c < cells; ++c)
      all(2 * c, t) = field.x.values[static_cast<std::size_t>(c)],
                 all(2 * c + 1, t) = field.y.values[static_cast<std::size_t>(c)];
  }
  return all;
}

std::vector<double> numbers(const Matrix& matrix) {
  return {matrix.data(), matrix.data() + matrix.size()};
}

Matrix matrix(const std::vector<double>& values, std::size_t columns) {
  const auto n = static_cast<Eigen::Index>(columns);
  return Eigen::Map<const Matrix>(values.data(), static_cast<Eigen::Index>(values.size()) / n, n);
}

// Sets the auto-regression of amplitudes whose stationary covariance is the identity.
void set_step(VelocityModes& modes, const Matrix& step) {
  const auto n = step.rows();
  const Matrix rest = Matrix::Identity(n, n) * (1 + kJitter) - step * step.transpose();
  modes.step = numbers(step);
  modes.noise = numbers(Matrix(Eigen::LLT<Matrix>(rest).matrixL()));
}

// Field that fits the steps, and shrinks towards 0.
Drift solve(const detail::CellEquations& equations, const CellMap& grid) {
  constexpr double precision = kPriorTracks / (4 * std::numbers::pi * kFieldReach * kFieldReach);
  const auto near = equations.spread(kFieldReach);
  Drift field{grid, grid};
  for (std::size_t c = 0; c < near.size(); ++c) {
    const graph::Point v = near[c].solve({0, 0}, precision);
    field.x.values[c] = v.x, field.y.values[c] = v.y;
  }
  return field;
}

void subtract_mean(std::vector<Drift>& fields) {
  for (const auto part : {&Drift::x, &Drift::y})
    for (std::size_t c = 0; c < (fields.front().*part).values.size(); ++c) {
      double mean = 0;
      for (const Drift& field : fields) mean += (field.*part).values[c] / static_cast<double>(fields.size());
      for (Drift& field : fields) (field.*part).values[c] -= mean;
    }
}

}  // namespace

std::vector<Drift> estimate_velocities(const std::vector<detail::CurveTrack>& tracks, const CellMap& grid,
                                       int frames) {
  std::vector<Drift> result;
  detail::visit_frames(tracks, static_cast<std::size_t>(frames),
                       [&](std::size_t frame, std::span<const std::uint32_t> there) {
                         if (frame == 0) return;
                         detail::CellEquations equations(grid);
                         for (const std::uint32_t i : there) {
                           const auto k = static_cast<int>(frame) - tracks[i].first;
                           if (k == 0) continue;
                           const auto* const sample = &tracks[i].samples[static_cast<std::size_t>(k)];
                           equations.add(sample->position, sample->normal,
                                         sample->normal_displacement - sample[-1].normal_displacement, 1);
                         }
                         result.push_back(solve(equations, grid));
                       });
  if (!result.empty()) subtract_mean(result);
  return result;
}

VelocityModes learn_velocity_modes(const std::vector<Drift>& velocities) {
  if (velocities.size() < kFewestFields) return {};
  const Matrix all = stacked(velocities);
  const auto fields = all.cols();
  const Eigen::SelfAdjointEigenSolver<Matrix> parts(all.transpose() * all / static_cast<double>(fields));
  const double energy = parts.eigenvalues().sum();
  if (!(energy > 0)) return {};
  Eigen::Index count = 0;
  for (double held = 0; count < std::min(kMostModes, fields / kFramesForMode) && held < kShareHeld * energy;
       ++count)
    held += parts.eigenvalues()(fields - 1 - count);
  const Matrix amplitudes = std::sqrt(static_cast<double>(fields)) *
                            parts.eigenvectors().rightCols(count).rowwise().reverse().transpose();
  VelocityModes modes;
  modes.count = static_cast<std::size_t>(count);
  modes.modes = numbers(Matrix(all * amplitudes.transpose() / static_cast<double>(fields)));
  set_step(modes, amplitudes.rightCols(fields - 1) * amplitudes.leftCols(fields - 1).transpose() /
                      static_cast<double>(fields));
  return modes;
}

Drift combine_modes(const VelocityModes& modes, const CellMap& grid, std::span<const double> amplitudes) {
  Drift field{grid, grid};
  const auto row = [&](std::size_t r) {
    double sum = 0;
    for (std::size_t k = 0; k < modes.count; ++k) sum += modes.modes[r * modes.count + k] * amplitudes[k];
    return sum;
  };
  for (std::size_t c = 0; c < grid.values.size(); ++c)
    field.x.values[c] = row(2 * c), field.y.values[c] = row(2 * c + 1);
  return field;
}

VelocityModes besides_sway(VelocityModes modes, const std::vector<detail::CurveTrack>& tracks,
                           const MotionModel& model) {
  double seen = 0, swaying = 0, steps = 0;
  const Autoregression& sway = model.displacement;
  const double deviation = stationary_deviation(sway), alike = sway.a1 / (1 - sway.a2);
  for (const auto& track : tracks) {
    const auto place = without_drift(track, model.drift_x, model.drift_y);
    for (std::size_t k = 1; k < place.size(); ++k) {
      const double share = model.displacement_scale.at(track.samples[k - 1].position);
      seen += std::pow(place[k] - place[k - 1], 2);
      swaying += 2 * std::pow(share * deviation, 2) * (1 - alike) + 2 * std::pow(sway.measurement, 2);
      ++steps;
    }
  }
  const double left = steps > 0 && seen > 0 ? 1 - swaying / seen : 0;
  if (left < kLeastLeft) return {};
  for (double& value : modes.modes) value *= std::sqrt(left);
  return modes;
}

VelocityModes reverse_modes(VelocityModes modes) {
  if (modes.count == 0) return modes;
  for (double& value : modes.modes) value = -value;
  set_step(modes, matrix(modes.step, modes.count).transpose());
  return modes;
}

}  // namespace emberfold::mcmc
