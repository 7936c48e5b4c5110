// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "dytex/learn.hpp"

namespace emberfold::dytex::detail {

/// The states of all frames, X = diag(s) Vᵀ (n × τ). V, τ × n, has orthonormal columns that sum to 0; s > 0.
struct UnitStates {
  Eigen::VectorXd s;
  Eigen::MatrixXd V;
};

/// x(t+1) = A x(t) + B v(t), fitted to states.
struct Dynamics {
  Eigen::MatrixXd A, B, states;
  double noise_share = 1;
  double least_squares_radius = 0;
  Transition transition = Transition::least_squares;
  bool noiseless = false;          ///< least squares was stable, but left nothing for the noise
  std::vector<std::string> notes;  ///< a line for everything that was not done as requested
};

/// Returns a note if clips drawn from a model vary much more or less than the clip.
/// None where both variances (`drawn`, `seen`) are within a factor of 1.5.
std::optional<std::string> variance_note(double drawn, double seen);

/// Returns the expected variance over time of each number of the state in clips of this number of frames,
/// drawn from the stationary state, about each clip's own mean: below the stationary variance, far below
/// where poles are slow. A is stable. O(n³ log frames).
Eigen::VectorXd variance_within(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, Eigen::Index frames);

/// Fits x(t+1) = A x(t) + B v(t). With the innovations form, the state's first n numbers are the components,
/// and their forecasts follow. Throws InputError where frames are too few. For the closed form O(n² τ + n³).
Dynamics fit_dynamics(const UnitStates& states, const LearnOptions& options);

}  // namespace emberfold::dytex::detail
