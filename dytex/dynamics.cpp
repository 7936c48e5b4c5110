// SPDX-License-Identifier: Apache-2.0
#include "dytex/dynamics.hpp"

#include <cmath>

#include "dytex/decompose.hpp"
#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr double kNoNoise = 1e-6;  // share of the states' size below which a residual is rounding

/// The residual of least squares over √(τ − 1), factored.
Eigen::MatrixXd least_squares_noise(const Eigen::MatrixXd& states, const Eigen::MatrixXd& A) {
  const Eigen::Index gaps = states.cols() - 1;
  const Eigen::MatrixXd residual = states.rightCols(gaps) - A * states.leftCols(gaps);
  return left_factor(residual / std::sqrt(static_cast<double>(gaps)));
}

/// With zeros before and behind the clip E Eᵀ = S² − A S² Aᵀ, so that the stationary covariance is the
/// data's.
Eigen::MatrixXd yule_walker_noise(const Eigen::MatrixXd& states, const Eigen::MatrixXd& A) {
  const Eigen::Index n = states.rows(), frames = states.cols();
  Eigen::MatrixXd residual(n, frames + 1);
  residual << states, Eigen::VectorXd::Zero(n);
  residual.rightCols(frames) -= A * states;
  return left_factor(residual / std::sqrt(static_cast<double>(frames)));
}

}  // namespace

Dynamics fit_dynamics(const Eigen::Ref<const Eigen::VectorXd>& s,
                      const Eigen::Ref<const Eigen::MatrixXd>& V) {
  const Eigen::Index n = V.cols(), frames = V.rows();
  Dynamics result;
  if (n == 0) {
    result.A = result.B = Eigen::MatrixXd(0, 0);
    return result;
  }
  const Eigen::MatrixXd states = s.asDiagonal() * V.transpose();
  const auto in_levels = [&](const Eigen::MatrixXd& white) -> Eigen::MatrixXd {
    return s.asDiagonal() * white * s.cwiseInverse().asDiagonal();
  };
  // In white states Vᵀ: Γ = Σ v(t+1) v(t)ᵀ, and Σ v(t) v(t)ᵀ over all but the last is I − u uᵀ, u the last,
  // whose inverse is known (Sherman and Morrison). 1 − uᵀu ≥ 1/τ, for V's columns sum to 0.
  const Eigen::MatrixXd gamma = V.bottomRows(frames - 1).transpose() * V.topRows(frames - 1);
  const Eigen::VectorXd u = V.row(frames - 1).transpose();
  const Eigen::MatrixXd least_squares = gamma + (gamma * u) * u.transpose() / (1 - u.squaredNorm());
  result.least_squares_radius = spectral_radius(least_squares);
  if (result.least_squares_radius < 1) {
    result.A = in_levels(least_squares);
    result.B = least_squares_noise(states, result.A);
    result.noiseless = result.B.norm() <= kNoNoise * s[0] / std::sqrt(static_cast<double>(frames));
    if (!result.noiseless && spectral_radius(result.A) < 1) return result;
  }
  result.yule_walker = true;
  result.A = in_levels(gamma);
  result.B = yule_walker_noise(states, result.A);
  return result;
}

}  // namespace emberfold::dytex::detail
