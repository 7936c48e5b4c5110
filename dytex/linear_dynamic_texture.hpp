// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/clip.hpp"

namespace emberfold::dytex {

/// A linear dynamic texture (Doretto, Chiuso, Wu, Soatto 2003, eq. 3; Soatto, Doretto, Wu 2001, eq. 3):
///   x(t+1) = A x(t) + B v(t),   v ~ N(0, I)
///   y(t)   = mean + C diag(weights) x(t)₁…ₙ + w(t),   w ~ N(0, r I), or N(0, diag(noise))
/// y(t) is a frame as a column of m = width · height · channels values in the order of its memory (row by
/// row, channels together), on the scale where white is 255. The state x has N ≥ n numbers; a frame shows the
/// first n. The others are a filter's own state. Where frames never change n and N are 0.
struct LinearDynamicTexture {
  core::ClipInfo info;      ///< of the clip it was learned from; `frames` is τ
  Eigen::VectorXf mean;     ///< m
  Eigen::MatrixXf C;        ///< m × n, orthonormal columns, by falling variance
  Eigen::VectorXd weights;  ///< n, of the components: ones until edited
  Eigen::MatrixXd A;        ///< N × N, spectral radius below 1
  Eigen::MatrixXd B;        ///< N × k, k ≤ N; Q = B Bᵀ
  double r = 0;  ///< residual variance after n components, levels², ≥ 0; the mean of `noise`, if any
  Eigen::VectorXf noise;     ///< m, that variance value by value, ≥ 0; empty where it is r everywhere
  double noise_share = 1;    ///< of the variance of what drove the clip, which B's k inputs keep, (0, 1]
  Eigen::MatrixXd states;    ///< N × τ, the training frames' states
  Eigen::VectorXd singular;  ///< all τ of the centred frames, falling

  [[nodiscard]] Eigen::Index components() const { return C.cols(); }  ///< n
  [[nodiscard]] Eigen::Index order() const { return A.rows(); }       ///< N
  [[nodiscard]] Eigen::Index pixels() const { return mean.size(); }   ///< m, values of a frame
};

/// Throws InputError, naming the part, where shapes disagree, a number is not finite, a variance or a
/// singular value is negative, or A's spectral radius is not below 1. O(m n + N³).
void validate(const LinearDynamicTexture& texture);

/// Returns the largest absolute eigenvalue of a square matrix, 0 of an empty one. InputError where an entry
/// is not finite. O(n³).
double spectral_radius(const Eigen::Ref<const Eigen::MatrixXd>& matrix);

/// Solves P = A P Aᵀ + B Bᵀ, the stationary covariance of the states, N × N. By doubling, O(n³) a step, some
/// log₂(40 / (1 − spectral radius)) steps. Throws NumericalError where A is not stable.
Eigen::MatrixXd stationary_covariance(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                      const Eigen::Ref<const Eigen::MatrixXd>& B);

/// Returns the expected state given its first n numbers, `shown`: P₍·₁₎ P₍₁₁₎⁻¹ times them, P the stationary
/// covariance. `shown` itself where N = n. Throws InputError where `shown` does not have n numbers. O(N³).
Eigen::VectorXd expected_state(const LinearDynamicTexture& texture,
                               const Eigen::Ref<const Eigen::VectorXd>& shown);

}  // namespace emberfold::dytex
