// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/context.hpp"

namespace emberfold::dytex::detail {

/// A = S⁻¹ O C S with O orthogonal and 0 ⪯ C ⪯ I: stable, and every stable matrix has the form (Gillis,
/// Karow, Sharma 2019).
struct StableForm {
  Eigen::MatrixXd S, O, C;
  [[nodiscard]] Eigen::MatrixXd matrix() const;
};

/// The objective of a stable fit: f(A) = ½ ‖diag(s) (V₂ − A V₁)‖² / s₁², V₁ and V₂ being V's first and
/// last τ − 1 rows, transposed.
struct StableObjective {
  Eigen::VectorXd squares;       ///< n: (s / s₁)²
  Eigen::MatrixXd gamma, first;  ///< V₂ V₁ᵀ, V₁ V₁ᵀ
  double constant = 0;           ///< ½ ‖diag(s) V₂‖² / s₁²

  StableObjective(const Eigen::VectorXd& s, const Eigen::MatrixXd& V);
  [[nodiscard]] double operator()(const Eigen::MatrixXd& A) const;
  /// Returns the gradient of f(S⁻¹ O C S), entry by entry of S, O and C.
  [[nodiscard]] StableForm gradient(const StableForm& form) const;
};

/// Finds the A (n × n, in states of unit size) of least error whose C stays at or below 1 − 1/(10 τ), by
/// projected fast gradient (Mamakoukas, Xherija, Murphey 2020). So no mode outlasts the clip more than ten
/// times. Begun from the Yule–Walker fit and from the least-squares fit made smaller; the error is at
/// most Yule–Walker's. O(n³) a step, at most some thousand.
Eigen::MatrixXd stable_fit(const Eigen::VectorXd& s, const Eigen::MatrixXd& V, const core::Context& context);

}  // namespace emberfold::dytex::detail
