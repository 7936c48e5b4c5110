// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace emberfold::dytex::detail {

/// x(t+1) = A x(t) + B v(t), edited.
struct EditedDynamics {
  Eigen::MatrixXd A, B;
  int dropped = 0;   ///< poles that became 0
  int together = 0;  ///< poles that could not be told from another, and were turned with it
  int wrapped = 0;   ///< poles whose phase went beyond π and wrapped around
  double cut = 0;    ///< share of the new noise's variance that was negative and was cut
};

/// Speed's A, and B as it was.
EditedDynamics at_speed(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double factor);
/// Flow's A, and the B with which the stationary covariance stays.
EditedDynamics at_flow(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double factor);
/// Reverse's.
EditedDynamics reversed(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// F O, with orthonormal rows of O, that is nearest to `like`: it has F's product with its transpose and the
/// columns of whichever has more. F: n × p, like: n × k. For the same noise this is `like` itself, and noises
/// that share their inputs go on sharing them.
Eigen::MatrixXd aligned_factor(const Eigen::MatrixXd& F, const Eigen::MatrixXd& like);

}  // namespace emberfold::dytex::detail
