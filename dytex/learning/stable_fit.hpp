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

/// What a stable fit is measured by: f(A) = ½ ‖diag(s) (V₂ − A V₁)‖² / s₁², V₁ and V₂ being V's first and
/// last τ − 1 rows, transposed.
struct StableObjective {
  Eigen::VectorXd squares;       ///< n: (s / s₁)²
  Eigen::MatrixXd gamma, first;  ///< V₂ V₁ᵀ, V₁ V₁ᵀ
  double constant = 0;           ///< ½ ‖diag(s) V₂‖² / s₁²

  StableObjective(const Eigen::VectorXd& s, const Eigen::MatrixXd& V);
  [[nodiscard]] double operator()(const Eigen::MatrixXd& A) const;
  /// Of f(S⁻¹ O C S), entry by entry of S, O and C.
  [[nodiscard]] StableForm gradient(const StableForm& form) const;
};

/// The A (n × n, in states of unit size) of least error whose C stays at or below 1 − 1/(10 τ): a mode is not
/// said to outlast the clip more than ten times (Mamakoukas, Xherija, Murphey 2020, by projected fast
/// gradient). Begun from the Yule–Walker fit and from the least-squares fit made smaller; the error is at
/// most Yule–Walker's. O(n³) a step, at most some thousand.
Eigen::MatrixXd stable_fit(const Eigen::VectorXd& s, const Eigen::MatrixXd& V, const core::Context& context);

}  // namespace emberfold::dytex::detail
