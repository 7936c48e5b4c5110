// SPDX-License-Identifier: Apache-2.0
#include "dytex/estimation/em_dynamics.hpp"

#include <limits>

#include "core/error.hpp"
#include "dytex/learning/decompositions.hpp"

namespace emberfold::dytex::detail {

namespace {

StateSpace with_first(const Smoothed& smoothed) {
  StateSpace space;
  space.first = smoothed.states.col(0);
  space.first_factor = symmetric_factor(smoothed.at(0).covariance);
  return space;
}

}  // namespace

Eigen::MatrixXd second_moment(const Smoothed& smoothed, Eigen::Index t) {
  return smoothed.at(t).covariance + smoothed.states.col(t) * smoothed.states.col(t).transpose();
}

Moments moments(const Smoothed& smoothed) {
  const Eigen::Index n = smoothed.states.rows(), frames = smoothed.states.cols(), gaps = frames - 1;
  const auto& x = smoothed.states;
  Moments sums;
  sums.before = x.leftCols(gaps) * x.leftCols(gaps).transpose();
  sums.after = x.rightCols(gaps) * x.rightCols(gaps).transpose();
  sums.cross = x.rightCols(gaps) * x.leftCols(gaps).transpose();
  Eigen::MatrixXd middle = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index t = 1; t < gaps; ++t) middle += smoothed.at(t).covariance;
  for (Eigen::Index t = 0; t < gaps; ++t) sums.cross += smoothed.at(t).with_next;
  sums.before += smoothed.at(0).covariance + middle;
  sums.after += middle + smoothed.at(frames - 1).covariance;
  return sums;
}

Eigen::MatrixXd divide_right(const Eigen::MatrixXd& N, const Eigen::MatrixXd& M) {
  if (M.size() == 0) return N;
  const CholeskyFactors factors(M);
  if (factors.positive()) return factors.right_divide(N);
  const SymmetricEigen eigen = symmetric_eigen(M);
  const double least =
      static_cast<double>(M.rows()) * std::numeric_limits<double>::epsilon() * eigen.values[0];
  const Eigen::VectorXd inverse =
      (eigen.values.array() > least).select(eigen.values.cwiseInverse(), Eigen::VectorXd::Zero(M.rows()));
  return N * eigen.vectors * inverse.asDiagonal() * eigen.vectors.transpose();
}

StateSpace maximise_dynamics(const Smoothed& smoothed) {
  const Moments sums = moments(smoothed);
  StateSpace space = with_first(smoothed);
  space.A = divide_right(sums.cross, sums.before);
  Eigen::MatrixXd Q = sums.after - space.A * sums.cross.transpose();
  Q = ((Q + Q.transpose()) / (2 * static_cast<double>(smoothed.states.cols() - 1))).eval();
  space.B = symmetric_factor(Q);
  if (!space.A.allFinite() || !space.B.allFinite())
    throw core::NumericalError("maximise_likelihood: the dynamics leave the range of numbers");
  return space;
}

StateSpace stable_dynamics(const Smoothed& smoothed) {
  const Moments sums = moments(smoothed);
  StateSpace space = with_first(smoothed);
  const Eigen::MatrixXd all = sums.before + second_moment(smoothed, smoothed.states.cols() - 1);
  space.A = divide_right(sums.cross, all);
  const Eigen::MatrixXd Q = all - space.A * sums.cross.transpose();
  space.B = symmetric_factor((Q + Q.transpose()) / (2 * static_cast<double>(smoothed.states.cols())));
  return space;
}

}  // namespace emberfold::dytex::detail
