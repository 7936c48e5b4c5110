// SPDX-License-Identifier: Apache-2.0
#include "dytex/synthesis/loop.hpp"

#include <string>

#include "core/error.hpp"
#include "dytex/learning/decompositions.hpp"
#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr double kLeastVariance = 1e-13;  // of the largest; directions below it do not move

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd power(MatrixXd base, int exponent) {
  MatrixXd result = MatrixXd::Identity(base.rows(), base.rows());
  for (; exponent > 0; exponent /= 2) {
    if (exponent % 2 == 1) result = (result * base).eval();
    base = (base * base).eval();
  }
  return result;
}

MatrixXd closing_matrix(const MatrixXd& once) {
  return inverse(MatrixXd::Identity(once.rows(), once.rows()) - once);
}

MatrixXd square_root(const MatrixXd& positive) {
  const SymmetricEigen eigen = symmetric_eigen(positive);
  return eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal() * eigen.vectors.transpose();
}

}  // namespace

MatrixXd loop_covariance(const MatrixXd& A, const MatrixXd& P, int frames) {
  const MatrixXd once = power(A, frames), close = closing_matrix(once);
  const MatrixXd result = close * (P - once * P * once.transpose()) * close.transpose();
  return (result + result.transpose()) / 2;
}

MatrixXd transport(const MatrixXd& from, const MatrixXd& to) {
  const SymmetricEigen eigen = symmetric_eigen(from);
  const Index rank = (eigen.values.array() > kLeastVariance * eigen.values[0]).count();
  const auto U = eigen.vectors.leftCols(rank);
  const VectorXd scale = eigen.values.head(rank).cwiseSqrt();
  const MatrixXd F = U * scale.asDiagonal(), inverse = U * scale.cwiseInverse().asDiagonal();
  return inverse * square_root(F.transpose() * to * F) * inverse.transpose();
}

MatrixXd loop_states(const MatrixXd& A, const MatrixXd& B, const MatrixXd& noise) {
  const Index n = A.rows(), frames = noise.cols();
  MatrixXd states = MatrixXd::Zero(n, frames);
  if (n == 0 || B.cols() == 0) return states;
  const MatrixXd driven = B * noise;
  VectorXd x = VectorXd::Zero(n);
  for (Index t = 0; t < frames; ++t) x = A * x + driven.col(t);
  x = closing_matrix(power(A, static_cast<int>(frames))) * x;
  for (Index t = 0; t < frames; ++t) {
    states.col(t) = x;
    x = A * x + driven.col(t);
  }
  const MatrixXd P = stationary_covariance(A, B);
  states = transport(loop_covariance(A, P, static_cast<int>(frames)), P) * states;
  if (!states.allFinite())
    throw core::NumericalError("a loop of " + std::to_string(frames) +
                               " frames cannot be closed: A is too near 1");
  return states;
}

}  // namespace emberfold::dytex::detail
