// SPDX-License-Identifier: Apache-2.0
#include "dytex/learning/decompositions.hpp"

#include <algorithm>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <unsupported/Eigen/MatrixFunctions>

#include "core/error.hpp"

namespace emberfold::dytex::detail {

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0) return {};
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  if (solver.info() != Eigen::Success)
    throw core::NumericalError("the eigenvalues of a symmetric matrix were not found");
  SymmetricEigen result{solver.eigenvalues().reverse(), solver.eigenvectors().rowwise().reverse()};
  for (auto column : result.vectors.colwise()) {
    Eigen::Index largest = 0;
    column.cwiseAbs().maxCoeff(&largest);
    if (column[largest] < 0) column = -column;
  }
  return result;
}

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix, false);
  if (solver.info() != Eigen::Success) throw core::NumericalError("the eigenvalues of A were not found");
  return solver.eigenvalues();
}

double largest_absolute_eigenvalue(const Eigen::MatrixXd& matrix) {
  return eigenvalues(matrix).cwiseAbs().maxCoeff();
}

Eigen::MatrixXd triangular_factor(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0) return Eigen::MatrixXd(0, matrix.cols());
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(matrix);
  return qr.matrixQR().topRows(std::min(matrix.rows(), matrix.cols())).triangularView<Eigen::Upper>();
}

Eigen::MatrixXd symmetric_factor(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0) return Eigen::MatrixXd(matrix.rows(), 0);
  const SymmetricEigen eigen = symmetric_eigen(matrix);
  const double least = std::max(eigen.values[0], 0.0) * static_cast<double>(matrix.rows()) *
                       std::numeric_limits<double>::epsilon();
  const Eigen::Index kept = (eigen.values.array() > least).count();
  return eigen.vectors.leftCols(kept) * eigen.values.head(kept).cwiseSqrt().asDiagonal();
}

Eigen::MatrixXd least_squares(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
  return matrix.completeOrthogonalDecomposition().solve(right);
}

Eigen::MatrixXd right_divide(const Eigen::MatrixXd& left, const Eigen::MatrixXd& matrix) {
  const CholeskyFactors factors(matrix);
  if (!factors.positive()) throw core::NumericalError("a covariance is singular");
  return factors.right_divide(left);
}

Eigen::MatrixXd thin_q(const Eigen::MatrixXd& matrix) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(matrix);
  return qr.householderQ() * Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols());
}

Eigen::MatrixXd full_q(const Eigen::MatrixXd& matrix) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(matrix).householderQ();
}

Eigen::MatrixXd inverse(const Eigen::MatrixXd& matrix) {
  return matrix.partialPivLu().inverse();
}

double determinant(const Eigen::MatrixXd& matrix) {
  return matrix.determinant();
}

struct LuFactors::Solver {
  Eigen::PartialPivLU<Eigen::MatrixXd> lu;
};

LuFactors::LuFactors(const Eigen::MatrixXd& matrix)
    : solver_(new Solver{Eigen::PartialPivLU<Eigen::MatrixXd>(matrix)}) {}

LuFactors::~LuFactors() = default;

Eigen::MatrixXd LuFactors::solve(const Eigen::MatrixXd& right) const {
  return solver_->lu.solve(right);
}

Eigen::VectorXd LuFactors::solve_vector(const Eigen::VectorXd& right) const {
  return solver_->lu.solve(right);
}

double LuFactors::log_determinant() const {
  return solver_->lu.matrixLU().diagonal().array().abs().log().sum();
}

struct CholeskyFactors::Solver {
  Eigen::LLT<Eigen::MatrixXd> llt;
};

CholeskyFactors::CholeskyFactors(const Eigen::MatrixXd& matrix)
    : solver_(new Solver{Eigen::LLT<Eigen::MatrixXd>(matrix)}) {}

CholeskyFactors::~CholeskyFactors() = default;

bool CholeskyFactors::positive() const {
  return solver_->llt.info() == Eigen::Success;
}

Eigen::MatrixXd CholeskyFactors::solve(const Eigen::MatrixXd& right) const {
  return solver_->llt.solve(right);
}

Eigen::MatrixXd CholeskyFactors::right_divide(const Eigen::MatrixXd& left) const {
  return solver_->llt.solve(left.transpose()).transpose();
}

Eigen::MatrixXd CholeskyFactors::solve_lower(const Eigen::MatrixXd& right) const {
  return solver_->llt.matrixL().solve(right);
}

Eigen::MatrixXd CholeskyFactors::right_divide_upper(const Eigen::MatrixXd& left) const {
  return solver_->llt.matrixL().solve(left.transpose()).transpose();
}

Eigen::MatrixXd CholeskyFactors::solve_upper(const Eigen::MatrixXd& right) const {
  return solver_->llt.matrixU().solve(right);
}

Eigen::MatrixXd CholeskyFactors::upper() const {
  return solver_->llt.matrixU();
}

double CholeskyFactors::log_determinant() const {
  return 2 * solver_->llt.matrixLLT().diagonal().array().log().sum();
}

RealSchur real_schur(const Eigen::MatrixXd& matrix) {
  const Eigen::RealSchur<Eigen::MatrixXd> solver(matrix);
  if (solver.info() != Eigen::Success) throw core::NumericalError("the Schur form of A was not found");
  return {solver.matrixT(), solver.matrixU()};
}

Eigen::MatrixXd matrix_power(const Eigen::MatrixXd& matrix, double exponent) {
  return matrix.pow(exponent);
}

}  // namespace emberfold::dytex::detail
