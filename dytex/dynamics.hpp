// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace emberfold::dytex::detail {

/// x(t+1) = A x(t) + B v(t), fitted to states.
struct Dynamics {
  Eigen::MatrixXd A, B;
  double least_squares_radius = 0;
  bool yule_walker = false;
  bool noiseless = false;  ///< least squares was stable, but left nothing for the noise
};

/// Fits the dynamics to the states X = diag(s) Vᵀ (n × τ). V, τ × n, has orthonormal columns that sum to 0;
/// s > 0. O(n² τ + n³).
Dynamics fit_dynamics(const Eigen::Ref<const Eigen::VectorXd>& s, const Eigen::Ref<const Eigen::MatrixXd>& V);

}  // namespace emberfold::dytex::detail
