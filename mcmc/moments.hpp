// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mcmc/lineages.hpp"
#include "mcmc/motion_model.hpp"

namespace emberfold::mcmc {

/// Sufficient statistics of an Autoregression: sums of products over all windows of five frames of all
/// lineages. Of a window, with d the deviation from the lineage's mean and g the neighbours' mean deviation
/// less its own: ψ = (d(t), d(t−1), …, d(t−4), g(t), …, g(t−4)). Sums of two clips add.
struct Moments {
  static constexpr int kLags = 5;
  using Matrix = Eigen::Matrix<double, 2 * kLags, 2 * kLags>;
  Matrix own = Matrix::Zero();  ///< Σ ψ ψᵀ
  double windows = 0;           ///< how many
  /// Σ d(t) d′(t) over pairs of lineages on one stroke, and how many, by their distance: up to 5 px, 10 px …
  std::array<double, 8> products{}, pairs{};

  Moments& operator+=(const Moments& other);
};

/// One attribute of every lineage: a series for each, of its samples' length.
using Series = std::vector<std::vector<double>>;

/// Lineages shorter than `shortest` frames are left out: their mean is no rest.
Moments moments(const graph::MotionGraph& motion, const std::vector<detail::Lineage>& lineages,
                const Series& series, bool turns_with_normal, std::size_t shortest);

struct Estimate {
  Autoregression motion;
  std::vector<std::string> notes;  ///< what was not taken as it came out
};

/// Least squares on the moments. What the sketch adds to the deviations in each frame alone would bias it
/// towards faster decay; where that can be told apart it is kept out by taking deviations three and four
/// frames back as instruments (two-stage least squares), which share no such error with the window's newest
/// three. What does not go on along the curve is taken for the sketch's, too: the noise gets the variance and
/// the range of what does. An estimate that is not stable is drawn back to a spectral radius of 0.995, and a
/// note says so. `what` names the attribute in notes.
Estimate estimate(const Moments& moments, const std::string& what);

}  // namespace emberfold::mcmc
