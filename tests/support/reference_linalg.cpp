// SPDX-License-Identifier: Apache-2.0
#include "tests/support/reference_linalg.hpp"

#include <algorithm>
#include <complex>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace emberfold::test {

using Eigen::MatrixXd;
using Eigen::VectorXd;

ThinSvd thin_svd(const MatrixXd& matrix) {
  const Eigen::JacobiSVD<MatrixXd> svd(matrix, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.matrixU(), svd.matrixV(), svd.singularValues()};
}

VectorXd singular_values(const MatrixXd& matrix) {
  return Eigen::JacobiSVD<MatrixXd>(matrix).singularValues();
}

SymmetricEigen symmetric_eigen(const MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

VectorXd symmetric_eigenvalues(const MatrixXd& matrix) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::VectorXcd eigenvalues(const MatrixXd& matrix) {
  return Eigen::EigenSolver<MatrixXd>(matrix, false).eigenvalues();
}

double eigenvalue_error(const MatrixXd& found, const MatrixXd& truth) {
  const Eigen::VectorXcd values = eigenvalues(found);
  double worst = 0;
  for (const std::complex<double> z : eigenvalues(truth))
    worst = std::max(worst, (values.array() - z).abs().minCoeff());
  return worst;
}

MatrixXd orthonormal_columns(const MatrixXd& matrix) {
  const Eigen::HouseholderQR<MatrixXd> qr(matrix);
  return qr.householderQ() * MatrixXd::Identity(matrix.rows(), matrix.cols());
}

MatrixXd least_squares(const MatrixXd& matrix, const MatrixXd& right) {
  return Eigen::ColPivHouseholderQR<MatrixXd>(matrix).solve(right);
}

MatrixXd cholesky_factor(const MatrixXd& matrix) {
  return Eigen::LLT<MatrixXd>(matrix).matrixL();
}

MatrixXd solve_positive(const MatrixXd& matrix, const MatrixXd& right) {
  return Eigen::LDLT<MatrixXd>(matrix).solve(right);
}

double log_determinant(const MatrixXd& matrix) {
  return 2 * Eigen::LLT<MatrixXd>(matrix).matrixLLT().diagonal().array().log().sum();
}

MatrixXd inverse(const MatrixXd& matrix) {
  return matrix.inverse();
}

}  // namespace emberfold::test
