// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "dytex/editing/pole_blocks.hpp"

namespace emberfold::dytex::detail {

/// x(t+1) = A x(t) + B v(t), edited.
struct EditedDynamics {
  Eigen::MatrixXd A, B;
  int dropped = 0;   ///< poles that became 0
  int together = 0;  ///< poles that could not be separated from another, and were turned with it
  int wrapped = 0;   ///< poles whose phase went beyond π and wrapped around
  double cut = 0;    ///< share of the new noise's variance that was negative and was cut
};

/// The form of A that Speed changes: A = basis · diagonal · inverse, found in white states. At the speed Ω a
/// block T of pairs that turn becomes T (cos θ I + sin θ J), θ = (Ω − 1) times its mean phase, or 0 where |Ω|
/// times that passes π; the others stay.
struct SpeedForm {
  Eigen::MatrixXd basis, inverse, diagonal;
  Eigen::MatrixXd quarter_turn;  ///< J of every block that turns, J² = −I; 0 elsewhere
  std::vector<PoleBlock> blocks;
};
/// Finds the form of A. `covariance`: the stationary one. O(N³).
SpeedForm speed_form(const Eigen::MatrixXd& A, const Eigen::MatrixXd& covariance);
/// Returns whether the block's poles are pairs that Speed turns. Real poles stay, and pairs joined with more
/// real ones.
bool turns(const PoleBlock& block);
/// Returns whether the block is one real pole or one pair, and none joined with others.
bool is_alone(const PoleBlock& block);
/// Returns whether the block's phase times the factor would pass π.
bool passes_half_turn(const PoleBlock& block, double factor);

/// Applies Speed to A; B stays.
EditedDynamics at_speed(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double factor);
/// Applies Flow to A, with the B that keeps the stationary covariance.
EditedDynamics at_flow(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double factor);
/// Stops states: A becomes nearly the identity, with the B that keeps the stationary covariance. In a frame
/// 2⁻³⁹ of the variance moves.
EditedDynamics at_rest(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
/// Applies Reverse to A, with the B that keeps the stationary covariance.
EditedDynamics reverse_dynamics(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// Returns the F O, with orthonormal rows of O, that is nearest to `like`. It has F Fᵀ as its product and
/// the wider one's number of columns. F: n × p, like: n × k. For the same noise this is `like` itself, and
/// noises that share their inputs still share them.
Eigen::MatrixXd aligned_factor(const Eigen::MatrixXd& F, const Eigen::MatrixXd& like);

}  // namespace emberfold::dytex::detail
