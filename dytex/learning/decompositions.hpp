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

/// R of M = Q R, Q with orthonormal columns: min(rows, columns) × columns, upper triangular, Rᵀ R = Mᵀ M.
Eigen::MatrixXd triangular_factor(const Eigen::MatrixXd& matrix);

/// F with F Fᵀ = M for a symmetric M, of which the lower half is read; what rounding made negative is 0.
/// Without columns of an eigenvalue below rows · ε times the largest.
Eigen::MatrixXd symmetric_factor(const Eigen::MatrixXd& matrix);

/// U Vᵀ of the singular value decomposition of a square matrix: the orthogonal matrix nearest to it.
Eigen::MatrixXd nearest_orthogonal(const Eigen::MatrixXd& matrix);

/// The smallest X with the least ‖M X − Y‖: a complete orthogonal decomposition.
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

/// X with X M = Y, M symmetric and positive definite; NumericalError where it is not.
Eigen::MatrixXd right_divide(const Eigen::MatrixXd& left, const Eigen::MatrixXd& matrix);

struct ThinSvd {
  Eigen::MatrixXd U, V;
  Eigen::VectorXd s;  ///< falling
};
ThinSvd thin_svd(const Eigen::MatrixXd& matrix);

/// Orthonormal columns that span those of a matrix with at least as many rows as columns (Householder).
Eigen::MatrixXd thin_q(const Eigen::MatrixXd& matrix);

/// M⁻¹ of a square matrix, by LU.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& matrix);

/// Falling; none of an empty matrix.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& matrix);

/// A = vectors · form · vectorsᵀ: `vectors` orthogonal, `form` block upper triangular with blocks of one row
/// (a real eigenvalue) or two (a pair).
struct RealSchur {
  Eigen::MatrixXd form, vectors;
};
/// Of a square, finite matrix. NumericalError where it does not converge.
RealSchur real_schur(const Eigen::MatrixXd& matrix);

/// The principal power of a square matrix without eigenvalues on the closed negative real axis.
Eigen::MatrixXd matrix_power(const Eigen::MatrixXd& matrix, double exponent);

/// The singular vectors of a p × k matrix: all p left ones, min(p, k) right ones.
struct SingularVectors {
  Eigen::MatrixXd left, right;
};
SingularVectors singular_vectors(const Eigen::MatrixXd& matrix);

}  // namespace emberfold::dytex::detail
