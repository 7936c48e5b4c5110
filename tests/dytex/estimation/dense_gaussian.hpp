// SPDX-License-Identifier: Apache-2.0
// A state space of small size as one Gaussian of all its states and frames: what filter, smoother and EM must
// agree with.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "dytex/estimation/kalman.hpp"

namespace emberfold::test {

/// How states look: y(t) = mean + C x(t) + w(t), w ~ N(0, diag(noise)).
struct Look {
  Eigen::MatrixXd C;
  Eigen::VectorXd mean, noise;
};

struct DenseGaussian {
  Eigen::MatrixXd states;      // n × τ: expected, given all that is seen
  Eigen::MatrixXd covariance;  // n τ × n τ
  double log_likelihood = 0;

  [[nodiscard]] Eigen::MatrixXd block(Eigen::Index t, Eigen::Index s) const {
    const Eigen::Index n = states.rows();
    return covariance.block(t * n, s * n, n, n);
  }
  /// E x(t) x(s)ᵀ
  [[nodiscard]] Eigen::MatrixXd moment(Eigen::Index t, Eigen::Index s) const {
    return block(t, s) + states.col(t) * states.col(s).transpose();
  }
};

/// Of what `seen` (m × τ, 1 or 0) leaves of the frames Y (m × τ).
inline DenseGaussian dense_gaussian(const dytex::StateSpace& space, const Look& look,
                                    const Eigen::MatrixXd& Y, const Eigen::MatrixXd& seen) {
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
  const Eigen::LLT<Eigen::MatrixXd> cholesky(S);
  const Eigen::VectorXd e = y - H * prior;
  DenseGaussian result;
  const Eigen::VectorXd x = prior + P * H.transpose() * cholesky.solve(e);
  result.states = Eigen::Map<const Eigen::MatrixXd>(x.data(), n, frames);
  result.covariance = P - P * H.transpose() * cholesky.solve(H * P);
  result.log_likelihood =
      -(static_cast<double>(count) * std::log(2 * std::numbers::pi) +
        2 * cholesky.matrixLLT().diagonal().array().log().sum() + e.dot(cholesky.solve(e))) /
      2;
  return result;
}

/// By the definition, value by value.
inline dytex::Observations plain_observations(const Look& look, const Eigen::MatrixXd& Y,
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
