// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace emberfold::dytex::detail {

/// Returns the stationary covariance of x on a circle of `frames` frames.
/// With x(t+1) = A x(t) + B v(t), L = `frames` and x(L) = x(0) it is (I − A^L)⁻¹ (P − A^L P A^Lᵀ) (I − A^L)⁻ᵀ
/// in every frame. P: the stationary covariance. A single real pole λ gives P (1 + λ^L)/(1 − λ^L).
Eigen::MatrixXd loop_covariance(const Eigen::MatrixXd& A, const Eigen::MatrixXd& P, int frames);

/// Makes states that repeat after the number of frames that `noise` has columns, v(0) … v(L − 1): N × L. They
/// are the circle's, x(0) = (I − A^L)⁻¹ Σ A^(L−1−j) B v(j), times the symmetric matrix that brings their
/// covariance back to P (in the directions that the noise reaches): a short circle magnifies modes that last
/// longer than it. O(L N²) + O(N³).
Eigen::MatrixXd loop_states(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::MatrixXd& noise);

/// Returns the symmetric M ⪰ 0 with M from M = to, on the range of `from`; 0 across it. O(N³).
Eigen::MatrixXd transport(const Eigen::MatrixXd& from, const Eigen::MatrixXd& to);

}  // namespace emberfold::dytex::detail
