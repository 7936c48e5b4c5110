// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <Eigen/Core>

/// All of Eigen's decompositions that dytex uses, behind plain functions: they take long to compile.
namespace emberfold::dytex::detail {

struct SymmetricEigen {
  Eigen::VectorXd values;   ///< falling
  Eigen::MatrixXd vectors;  ///< a column each; its entry of largest size is positive
};
/// Decomposes a symmetric matrix, of which the lower half is read. NumericalError where it does not converge.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix);

/// Returns the eigenvalues of a square matrix, in no order; a complex pair is adjacent. NumericalError where
/// they do not converge. O(n³).
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix);

/// Returns the spectral radius of a square, finite matrix with at least one row. NumericalError where the
/// eigenvalues do not converge.
double largest_absolute_eigenvalue(const Eigen::MatrixXd& matrix);

/// Returns F with F Fᵀ = M Mᵀ and at most as many columns as rows: U S of the thin singular value
/// decomposition. Columns of a singular value below max(rows, columns) · ε times the largest are left out.
Eigen::MatrixXd left_factor(const Eigen::MatrixXd& matrix);

/// Returns R of M = Q R, Q with orthonormal columns: min(rows, columns) × columns, upper triangular.
Eigen::MatrixXd triangular_factor(const Eigen::MatrixXd& matrix);

/// Returns F with F Fᵀ = M for a symmetric M, of which the lower half is read. Columns of an eigenvalue below
/// rows · ε times the largest, and so those that rounding made negative, are left out.
Eigen::MatrixXd symmetric_factor(const Eigen::MatrixXd& matrix);

/// Returns the smallest X with the least ‖M X − Y‖ (complete orthogonal decomposition).
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

/// Returns X with X M = Y, M symmetric and positive definite. NumericalError where it is not.
Eigen::MatrixXd right_divide(const Eigen::MatrixXd& left, const Eigen::MatrixXd& matrix);

/// A thin singular value decomposition M = U diag(s) Vᵀ.
struct ThinSvd {
  Eigen::MatrixXd U, V;
  Eigen::VectorXd s;  ///< falling
};
/// Decomposes any matrix, an empty one too.
ThinSvd thin_svd(const Eigen::MatrixXd& matrix);

/// Returns orthonormal columns that span those of a matrix with at least as many rows as columns
/// (Householder).
Eigen::MatrixXd thin_q(const Eigen::MatrixXd& matrix);
/// Returns all of Q, a square orthogonal matrix whose first columns thin_q() gives.
Eigen::MatrixXd full_q(const Eigen::MatrixXd& matrix);

/// Returns M⁻¹ of a square matrix, by LU.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& matrix);

/// Returns the determinant of a square matrix, by LU.
double determinant(const Eigen::MatrixXd& matrix);

/// A square matrix factored by LU with partial pivoting, for several right sides.
class LuFactors {
 public:
  explicit LuFactors(const Eigen::MatrixXd& matrix);
  ~LuFactors();
  LuFactors(const LuFactors&) = delete;
  LuFactors& operator=(const LuFactors&) = delete;

  /// Returns M⁻¹ times the right side.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
  [[nodiscard]] Eigen::VectorXd solve_vector(const Eigen::VectorXd& right) const;
  /// Returns log |det M|.
  [[nodiscard]] double log_determinant() const;

 private:
  struct Solver;
  std::unique_ptr<const Solver> solver_;
};

/// M = L Lᵀ of a symmetric matrix, of which the lower half is read.
class CholeskyFactors {
 public:
  explicit CholeskyFactors(const Eigen::MatrixXd& matrix);
  ~CholeskyFactors();
  CholeskyFactors(const CholeskyFactors&) = delete;
  CholeskyFactors& operator=(const CholeskyFactors&) = delete;

  /// Returns whether M is positive definite. The others are valid only then.
  [[nodiscard]] bool positive() const;
  /// Returns M⁻¹ Y.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
  /// Returns Y M⁻¹.
  [[nodiscard]] Eigen::MatrixXd right_divide(const Eigen::MatrixXd& left) const;
  /// Returns L⁻¹ Y.
  [[nodiscard]] Eigen::MatrixXd solve_lower(const Eigen::MatrixXd& right) const;
  /// Returns Y L⁻ᵀ.
  [[nodiscard]] Eigen::MatrixXd right_divide_upper(const Eigen::MatrixXd& left) const;
  /// Returns L⁻ᵀ Y.
  [[nodiscard]] Eigen::MatrixXd solve_upper(const Eigen::MatrixXd& right) const;
  /// Returns Lᵀ.
  [[nodiscard]] Eigen::MatrixXd upper() const;
  [[nodiscard]] double log_determinant() const;

 private:
  struct Solver;
  std::unique_ptr<const Solver> solver_;
};

/// Returns the singular values, falling, none of an empty matrix.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& matrix);

/// A = vectors · form · vectorsᵀ: `vectors` orthogonal, `form` block upper triangular with blocks of one row
/// (a real eigenvalue) or two (a pair).
struct RealSchur {
  Eigen::MatrixXd form, vectors;
};
/// Decomposes a square, finite matrix. NumericalError where it does not converge.
RealSchur real_schur(const Eigen::MatrixXd& matrix);

/// Returns the principal power of a square matrix without eigenvalues on the closed negative real axis.
Eigen::MatrixXd matrix_power(const Eigen::MatrixXd& matrix, double exponent);

/// The singular vectors of a p × k matrix: all p left ones, min(p, k) right ones.
struct SingularVectors {
  Eigen::MatrixXd left, right;
};
/// Decomposes any matrix, an empty one too.
SingularVectors singular_vectors(const Eigen::MatrixXd& matrix);

}  // namespace emberfold::dytex::detail
