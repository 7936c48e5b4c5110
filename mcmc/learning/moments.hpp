// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mcmc/learning/ar_likelihood.hpp"
#include "mcmc/learning/curve_tracks.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::mcmc {

/// Of an attribute's deviations how they go on beside each other: sums of products over all windows of five
/// frames of all lineages. Of a window, with d the deviation from the lineage's mean and g the neighbours'
/// mean deviation less its own: ψ = (d(t), d(t−1), …, d(t−4), g(t), …, g(t−4)). Sums of two clips add.
struct Moments {
  static constexpr int kLags = 5;
  using Matrix = Eigen::Matrix<double, 2 * kLags, 2 * kLags>;
  Matrix own = Matrix::Zero();  ///< Σ ψ ψᵀ
  double windows = 0;           ///< how many
  /// Of pairs of lineages on one stroke, with s = d(t) − d(t−4): Σ s s′, Σ (s² + s′²)/2, and how many, by
  /// their distance: up to 5 px, 10 px …
  std::array<double, 12> products{}, squares{}, pairs{};

  Moments& operator+=(const Moments& other);
};

/// Of normal numbers their variance, with little said by some that have gone astray: from the mean root of
/// their moduli (Cressie and Hawkins 1980).
class RobustVariance {
 public:
  /// Of numbers of this variance the mean root of the moduli.
  static double root(double variance) { return std::pow(kOfOne * variance, 0.25); }
  static double variance(double root) { return std::pow(root, 4) / kOfOne; }

  void add(double value) { roots_ += std::sqrt(std::abs(value)), ++count_; }
  [[nodiscard]] double value() const { return count_ > 0 ? variance(roots_ / count_) : 0; }

 private:
  static constexpr double kOfOne = 0.45695;  // (E√|z|)⁴ of a standard normal z
  double roots_ = 0, count_ = 0;
};

/// One attribute of every lineage: a series for each, of its samples' length.
using Series = std::vector<std::vector<double>>;

/// What an Autoregression is learned from. Those of several clips add.
struct Observed {
  Moments moments;                  ///< of lineages of 12 frames or more: shorter ones tell no rest
  std::vector<detail::Path> paths;  ///< of lineages of 6 frames or more

  Observed& operator+=(const Observed& other);
};

Observed observe(const graph::MotionGraph& motion, const std::vector<detail::Lineage>& lineages,
                 const Series& series, bool turns_with_normal);

struct Estimate {
  Autoregression motion;
  detail::SwayLaw law;             ///< as it came out, of a usual path
  std::vector<std::string> notes;  ///< what was not taken as it came out
};

/// Maximum likelihood over the paths (mcmc/learning/ar_likelihood.hpp): a1 (its mean over paths), a2, noise
/// and measurement. The coupling comes before, by two-stage least squares on the moments with deviations
/// three and four frames back as instruments, which share no measurement error with the window's newest
/// three; it is 0 where that gives nothing sound. What does not go on along the curve is taken for the
/// sketch's, too: the noise gets the variance and the range of what does. Laws have a spectral radius of
/// 0.995 at most; a note says where that held one back. `what` names the attribute in notes.
Estimate estimate(const Observed& seen, const std::string& what);

}  // namespace emberfold::mcmc
