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

/// Sums products of deviations over all windows of five frames of all tracks.
/// In a window d is the deviation from the track's mean and g the neighbours' mean deviation less d:
/// ψ = (d(t), d(t−1), …, d(t−4), g(t), …, g(t−4)). The sums of two clips add.
struct Moments {
  static constexpr int kLags = 5;
  using Matrix = Eigen::Matrix<double, 2 * kLags, 2 * kLags>;
  Matrix own = Matrix::Zero();  ///< Σ ψ ψᵀ
  double windows = 0;           ///< number of windows
  /// For pairs of tracks on one stroke, with s = d(t) − d(t−4): Σ s s′, Σ (s² + s′²)/2 and the number of
  /// pairs, by distance: up to 5 px, 10 px, …
  std::array<double, 12> products{}, squares{}, pairs{};
};

/// Estimates the variance of normal numbers robustly, from the mean root of their moduli (Cressie & Hawkins
/// 1980).
class RobustVariance {
 public:
  /// Returns the mean root of the moduli of numbers of this variance.
  static double root(double variance) { return std::pow(kUnitRoot * variance, 0.25); }
  /// Returns the variance of numbers with this mean root of the moduli.
  static double variance(double root) { return std::pow(root, 4) / kUnitRoot; }

  void add(double value) { roots_ += std::sqrt(std::abs(value)), ++count_; }
  [[nodiscard]] double value() const { return count_ > 0 ? variance(roots_ / count_) : 0; }

 private:
  static constexpr double kUnitRoot = 0.45695;  // (E√|z|)⁴ of a standard normal z
  double roots_ = 0, count_ = 0;
};

/// One attribute of every track: a series for each, as long as its samples.
using Series = std::vector<std::vector<double>>;

/// Holds what an Autoregression is learned from.
struct MotionObservations {
  Moments moments;                           ///< of tracks of 12 frames or more: shorter ones show no rest
  std::vector<detail::DeviationPath> paths;  ///< of tracks of 6 frames or more
};

/// Collects the observations of one attribute of a clip's tracks. `turns_with_normal`: whether its sign
/// depends on the sense of the normal. O(samples + pairs of tracks on a stroke).
MotionObservations collect_observations(const graph::MotionGraph& motion,
                                        const std::vector<detail::CurveTrack>& tracks, const Series& series,
                                        bool turns_with_normal);

/// Holds an estimated law of motion.
struct MotionEstimate {
  Autoregression motion;
  detail::MotionLaw law;           ///< as estimated, of a typical path
  std::vector<std::string> notes;  ///< one line for each number that was not taken as estimated
};

/// Estimates a1 (its mean over paths), a2, noise and measurement by maximum likelihood
/// (mcmc/learning/ar_likelihood.hpp).
/// The coupling comes first, by two-stage least squares on the moments; its instruments are deviations three
/// and four frames back, which share no measurement error with the window's newest three. An unsound coupling
/// is 0. Variance that is not shared along the curve counts as the sketch's error: the noise gets the
/// variance and the range of the rest. Spectral radii are at most 0.995; a note names a law held there.
/// `what` names the attribute in notes.
MotionEstimate estimate_motion(const MotionObservations& seen, const std::string& what);

}  // namespace emberfold::mcmc
