// SPDX-License-Identifier: Apache-2.0
// Eigen's decompositions behind plain functions, compiled once for all tests: they take long to compile.
#pragma once

#include <Eigen/Core>

namespace emberfold::test {

/// A thin singular value decomposition M = U diag(s) Vᵀ; s falls.
struct ThinSvd {
  Eigen::MatrixXd U, V;
  Eigen::VectorXd s;
};
/// Decomposes a matrix by Jacobi rotations.
ThinSvd thin_svd(const Eigen::MatrixXd& matrix);
/// Returns the singular values, falling.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& matrix);

/// Eigenvalues of a symmetric matrix, rising, and its eigenvectors, a column each.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
/// Decomposes a symmetric matrix, of which the lower half is read.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix);
/// Returns the eigenvalues of a symmetric matrix, rising, without its vectors.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix);
/// Returns the eigenvalues of a square matrix, in no order.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix);
/// Returns the largest distance of an eigenvalue of `truth` from the nearest one of `found`.
double eigenvalue_error(const Eigen::MatrixXd& found, const Eigen::MatrixXd& truth);

/// Returns orthonormal columns that span those of a matrix (Householder QR).
Eigen::MatrixXd orthonormal_columns(const Eigen::MatrixXd& matrix);
/// Returns the X of least ‖M X − Y‖ (QR with column pivoting).
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

/// Returns the lower triangular L with L Lᵀ = M, M symmetric and positive definite.
Eigen::MatrixXd cholesky_factor(const Eigen::MatrixXd& matrix);
/// Returns M⁻¹ Y for a symmetric, positive definite M.
Eigen::MatrixXd solve_positive(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);
/// Returns log det M for a symmetric, positive definite M.
double log_determinant(const Eigen::MatrixXd& matrix);
/// Returns M⁻¹ of a square matrix (LU).
Eigen::MatrixXd inverse(const Eigen::MatrixXd& matrix);

}  // namespace emberfold::test
