// SPDX-License-Identifier: Apache-2.0
// A state space of small size as one Gaussian of all its states and frames: what filter, smoother and EM must
// agree with.
#pragma once

#include <Eigen/Core>

#include "dytex/estimation/kalman.hpp"

namespace emberfold::test {

/// Observation model of the states: y(t) = mean + C x(t) + w(t), w ~ N(0, diag(noise)).
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

/// Law of the seen values (`seen`: m × τ, 1 or 0) of the frames Y (m × τ).
DenseGaussian dense_gaussian(const dytex::StateSpace& space, const Look& look, const Eigen::MatrixXd& Y,
                             const Eigen::MatrixXd& seen);

/// By the definition, value by value.
dytex::Observations plain_observations(const Look& look, const Eigen::MatrixXd& Y,
                                       const Eigen::MatrixXd& seen);

}  // namespace emberfold::test
