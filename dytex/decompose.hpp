// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

/// Eigen's decompositions, which take long to compile, behind plain functions.
namespace emberfold::dytex::detail {

struct SymmetricEigen {
  Eigen::VectorXd values;   ///< falling
  Eigen::MatrixXd vectors;  ///< a column each; its entry of largest size is positive
};
/// Of a symmetric matrix, of which the lower half is read. NumericalError where it does not converge.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix);

/// Of a square, finite matrix with at least one row. NumericalError where it does not converge.
double largest_absolute_eigenvalue(const Eigen::MatrixXd& matrix);

/// U S of the thin singular value decomposition, without columns of a singular value below
/// max(rows, columns) · ε times the largest: F with F Fᵀ = M Mᵀ, at most as many columns as rows.
Eigen::MatrixXd left_factor(const Eigen::MatrixXd& matrix);

/// Falling; none of an empty matrix.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& matrix);

}  // namespace emberfold::dytex::detail
