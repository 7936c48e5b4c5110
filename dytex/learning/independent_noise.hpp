// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/context.hpp"

namespace emberfold::dytex::detail {

/// Rotates white inputs until they are independent, R v = s, by symmetric FastICA with log cosh (Hyvärinen
/// 1999): each row w of R becomes E[v tanh(wᵀv)] − E[1 − tanh²(wᵀv)] w, all are made orthonormal together.
/// Returns R, k × k, orthogonal. v: k × any number, mean 0 and covariance I; `start`: R to begin from.
/// Ends when no row turns by more than 1e-6 rad, or after 200 steps, O(k² T) each. Deterministic.
Eigen::MatrixXd fast_ica(const Eigen::MatrixXd& v, const Eigen::MatrixXd& start,
                         const core::Context& context = {});

/// Returns by how much the log-likelihood of `later` under a generalised normal density fitted to `earlier`
/// (median, scale and shape 0.3 … 8 by likelihood) is above that of the normal density that fits `later`
/// best. If all is normal, its exponential has an expectation of at most 1 (universal inference: Wasserman,
/// Ramdas, Balakrishnan 2020), so it is above log(1/α) with a probability of at most α. Nats.
double gain_over_normal(const Eigen::VectorXd& earlier, const Eigen::VectorXd& later);

/// Returns quantiles of a sample, made so that the distribution that is linear between them has mean 0 and
/// variance 1: sorted values, the same number as the sample's. The sample must not be constant.
Eigen::RowVectorXd standard_quantiles(const Eigen::VectorXd& sample);

/// Inputs that are not normal, found in the noise of a clip.
struct IndependentNoise {
  Eigen::MatrixXd turn;       ///< k × k, orthogonal: s = turn · v, those that are not normal first
  Eigen::MatrixXd marginals;  ///< j × T, 1 ≤ j ≤ k: their standard_quantiles()
};

/// Finds independent inputs and those of them that are not normal. R comes from every second input; an input
/// counts as not normal where its gain_over_normal() in the others is above log(k / 0.05), so all of a normal
/// clip is found normal with probability 0.95 or more. R is then refined on all. None where no input passes,
/// or there are fewer than 8 k + 32 samples. v: k × T, mean 0, covariance I.
std::optional<IndependentNoise> independent_noise(const Eigen::MatrixXd& v,
                                                  const core::Context& context = {});

}  // namespace emberfold::dytex::detail
