// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "dytex/estimation/kalman.hpp"

namespace emberfold::dytex::detail {

/// Sums over a smoothed sequence of expected second moments of its states.
struct Moments {
  Eigen::MatrixXd before;  ///< Σ E x(t) x(t)ᵀ over all frames but the last
  Eigen::MatrixXd after;   ///< the same over all but the first
  Eigen::MatrixXd cross;   ///< Σ E x(t+1) x(t)ᵀ
};
/// Sums the moments of a smoothed sequence. O(n² τ).
Moments moments(const Smoothed& smoothed);

/// Returns E x(t) x(t)ᵀ.
Eigen::MatrixXd second_moment(const Smoothed& smoothed, Eigen::Index t);

/// Finds the dynamics that make the smoothed sequence most likely (Shumway, Stoffer 1982, eq. 12 to 14):
/// A = S₁₀ S₀₀⁻¹, Q = (S₁₁ − A S₁₀ᵀ)/(τ − 1), x(0) as smoothed. At least 2 frames. O(n² τ + n³).
StateSpace maximise_dynamics(const Smoothed& smoothed);

/// Finds the Yule–Walker dynamics of a smoothed sequence: A = S₁₀ S⁻¹ with S over all frames. Always stable;
/// Q keeps S/τ as the stationary covariance.
StateSpace stable_dynamics(const Smoothed& smoothed);

/// Solves X M = N for a symmetric positive M, of which the lower half is read.
Eigen::MatrixXd divide_right(const Eigen::MatrixXd& N, const Eigen::MatrixXd& M);

}  // namespace emberfold::dytex::detail
