// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/clip.hpp"

namespace emberfold::dytex {

/// A linear dynamic texture (Doretto, Chiuso, Wu, Soatto 2003, eq. 3; Soatto, Doretto, Wu 2001, eq. 3):
///   x(t+1) = A x(t) + B v(t),   v ~ N(0, I)
///   y(t)   = mean + C x(t) + w(t),   w ~ N(0, r I)
/// y(t) is a frame as a column of m = width · height · channels values in the order of its memory (row by
/// row, channels together), on the scale where white is 255. Where frames never change the order n is 0.
struct LinearDynamicTexture {
  core::ClipInfo info;       ///< of the clip it was learned from; `frames` is τ
  Eigen::VectorXf mean;      ///< m
  Eigen::MatrixXf C;         ///< m × n, orthonormal columns, by falling variance
  Eigen::MatrixXd A;         ///< n × n, spectral radius below 1
  Eigen::MatrixXd B;         ///< n × k, k ≤ n; Q = B Bᵀ
  double r = 0;              ///< variance of what n components leave, levels², ≥ 0
  Eigen::MatrixXd states;    ///< n × τ, the training frames' states
  Eigen::VectorXd singular;  ///< all τ singular values of the centred frames, falling

  [[nodiscard]] Eigen::Index order() const { return A.rows(); }
  [[nodiscard]] Eigen::Index pixels() const { return mean.size(); }
};

/// Throws InputError, naming the part, where shapes disagree, a number is not finite, r or a singular value
/// is negative, or A's spectral radius is not below 1. O(m n + n³).
void validate(const LinearDynamicTexture& texture);

/// The largest absolute eigenvalue of a square matrix, 0 of an empty one; InputError where an entry is not
/// finite. O(n³).
double spectral_radius(const Eigen::Ref<const Eigen::MatrixXd>& matrix);

/// P = A P Aᵀ + B Bᵀ, n × n: the covariance of the states in the long run. By doubling, O(n³) a step, some
/// log₂(40 / (1 − spectral radius)) steps. NumericalError where A is not stable.
Eigen::MatrixXd stationary_covariance(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                      const Eigen::Ref<const Eigen::MatrixXd>& B);

}  // namespace emberfold::dytex
