// SPDX-License-Identifier: Apache-2.0
// Models whose poles and covariances are known, for the tests of edits.
#pragma once

#include <vector>

#include "tests/support/matrices.hpp"

namespace emberfold::test {

/// r times a turn by `phase`.
Eigen::Matrix2d pair_block(double r, double phase);

struct Pole {
  double modulus = 0;  ///< of a real pole with its sign
  double phase = -1;   ///< of a pair; −1: a real pole
};

/// The block-diagonal matrix with these poles.
Eigen::MatrixXd diagonal_of(const std::vector<Pole>& poles);

/// A well-conditioned change of basis that is not orthogonal.
Eigen::MatrixXd basis(Eigen::Index n, std::uint64_t seed);

/// A texture of 8 × 7 px with the given dynamics, all components shown.
dytex::LinearDynamicTexture texture_of(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                                       Eigen::Index components = -1);

dytex::LinearDynamicTexture texture_with(const std::vector<Pole>& poles, std::uint64_t seed = 1);

/// n states, radius `radius`, k noises.
dytex::LinearDynamicTexture random_texture(Eigen::Index n, double radius, std::uint64_t seed,
                                           Eigen::Index inputs = -1);

Eigen::MatrixXd covariance(const dytex::LinearDynamicTexture& texture);

/// Γ(k) = A^k P.
Eigen::MatrixXd lag_covariance(const dytex::LinearDynamicTexture& texture, int k);

double apart(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

}  // namespace emberfold::test
