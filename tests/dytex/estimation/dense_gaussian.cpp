// SPDX-License-Identifier: Apache-2.0
#include "tests/dytex/estimation/dense_gaussian.hpp"

#include <cmath>
#include <numbers>

#include "tests/support/reference_linalg.hpp"

namespace emberfold::test {

DenseGaussian dense_gaussian(const dytex::StateSpace& space, const Look& look, const Eigen::MatrixXd& Y,
                             const Eigen::MatrixXd& seen) {
  const Eigen::Index n = space.A.rows(), frames = Y.cols(), k = space.B.cols(),
                     k0 = space.first_factor.cols();
  // All states as a linear map of x(0)'s and the driving noises.
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(n * frames, k0 + k * (frames - 1));
  Eigen::VectorXd prior(n * frames);
  map.topLeftCorner(n, k0) = space.first_factor;
  prior.head(n) = space.first;
  for (Eigen::Index t = 1; t < frames; ++t) {
    map.middleRows(t * n, n) = space.A * map.middleRows((t - 1) * n, n);
    map.block(t * n, k0 + (t - 1) * k, n, k) += space.B;
    prior.segment(t * n, n) = space.A * prior.segment((t - 1) * n, n);
  }
  const Eigen::MatrixXd P = map * map.transpose();
  const auto count = static_cast<Eigen::Index>(seen.sum());
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(count, n * frames);
  Eigen::VectorXd y(count), noise(count);
  Eigen::Index row = 0;
  for (Eigen::Index t = 0; t < frames; ++t)
    for (Eigen::Index i = 0; i < Y.rows(); ++i) {
      if (seen(i, t) == 0) continue;
      H.block(row, t * n, 1, n) = look.C.row(i);
      y[row] = Y(i, t) - look.mean[i];
      noise[row++] = look.noise[i];
    }
  Eigen::MatrixXd S = H * P * H.transpose();
  S.diagonal() += noise;
  const Eigen::VectorXd e = y - H * prior, weighted = solve_positive(S, e);
  DenseGaussian result;
  const Eigen::VectorXd x = prior + P * H.transpose() * weighted;
  result.states = Eigen::Map<const Eigen::MatrixXd>(x.data(), n, frames);
  result.covariance = P - P * H.transpose() * solve_positive(S, H * P);
  result.log_likelihood =
      -(static_cast<double>(count) * std::log(2 * std::numbers::pi) + log_determinant(S) + e.dot(weighted)) /
      2;
  return result;
}

dytex::Observations plain_observations(const Look& look, const Eigen::MatrixXd& Y,
                                       const Eigen::MatrixXd& seen) {
  dytex::Observations result;
  const Eigen::Index n = look.C.cols(), frames = Y.cols();
  result.vectors = Eigen::MatrixXd::Zero(n, frames);
  result.squares = result.constants = Eigen::VectorXd::Zero(frames);
  for (Eigen::Index t = 0; t < frames; ++t) {
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < Y.rows(); ++i) {
      if (seen(i, t) == 0) continue;
      const double e = Y(i, t) - look.mean[i];
      information += look.C.row(i).transpose() * look.C.row(i) / look.noise[i];
      result.vectors.col(t) += look.C.row(i).transpose() * e / look.noise[i];
      result.squares[t] += e * e / look.noise[i];
      result.constants[t] += std::log(2 * std::numbers::pi * look.noise[i]);
    }
    if (seen.col(t).sum() == 0) {
      result.which.push_back(-1);
    } else if (t > 0 && result.which.back() >= 0 && seen.col(t) == seen.col(t - 1)) {
      result.which.push_back(result.which.back());
    } else {
      result.which.push_back(static_cast<int>(result.information.size()));
      result.information.push_back(information);
    }
  }
  return result;
}

}  // namespace emberfold::test
