// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace emberfold::dytex {

/// x(t+1) = A x(t) + B v(t),  v ~ N(0, I),  from  x(0) ~ N(first, F Fᵀ), F the first factor.
struct StateSpace {
  Eigen::MatrixXd A;             ///< n × n
  Eigen::MatrixXd B;             ///< n × k
  Eigen::VectorXd first;         ///< n
  Eigen::MatrixXd first_factor;  ///< n × any
};

/// The information of frames y(t) = mean + C x(t) + w(t), w ~ N(0, R), R diagonal, about their states. Sums
/// run over the values that are seen of a frame.
struct Observations {
  Eigen::MatrixXd vectors;                   ///< n × τ: Cᵀ R⁻¹ (y − mean)
  Eigen::VectorXd squares;                   ///< τ: (y − mean)ᵀ R⁻¹ (y − mean)
  Eigen::VectorXd constants;                 ///< τ: Σ log(2π R)
  std::vector<Eigen::MatrixXd> information;  ///< n × n each: the different values of Cᵀ R⁻¹ C
  std::vector<int> which;                    ///< τ: a frame's information; −1 where nothing of it is seen

  [[nodiscard]] Eigen::Index frames() const { return vectors.cols(); }
};

/// Covariances of one frame's state, as factors: P = F Fᵀ. n × at most n each, but for frame 0.
struct FilterStep {
  Eigen::MatrixXd predicted;  ///< given the frames before
  Eigen::MatrixXd filtered;   ///< given this frame too
  double log_volume = 0;      ///< log det(I + Cᵀ R⁻¹ C P)
};

struct Filtered {
  Eigen::MatrixXd predicted;      ///< n × τ: E x(t) given the frames before t
  Eigen::MatrixXd states;         ///< n × τ: E x(t) given the frames up to t
  std::vector<FilterStep> steps;  ///< the different ones: from some frame on all are the same
  std::vector<int> step;          ///< τ: a frame's step
  double log_likelihood = 0;      ///< of all values seen, natural logarithm
};

/// Filters states forwards (Kalman) in n dimensions, whatever the number of pixels. With P = F Fᵀ predicted,
/// K = Cᵀ R⁻¹ C and I + Fᵀ K F = L Lᵀ, the filtered factor is F L⁻ᵀ and the next predicted one comes from a
/// QR of A times it and B. No covariance is inverted or subtracted from, so that all stay symmetric and not
/// negative. Covariances are kept once they change by less than 1e-12 of themselves, for as long as frames
/// show the same values. Throws InputError where shapes disagree or an entry is not finite; NumericalError
/// where a number leaves the range of double. O(n³) a frame until then, O(n²) after.
Filtered filter(const StateSpace& space, const Observations& observations);

struct SmootherStep {
  Eigen::MatrixXd covariance;  ///< n × n: of x(t) given all frames
  Eigen::MatrixXd with_next;   ///< n × n: of x(t+1) (rows) and x(t) (columns) given all; empty in the last
};

struct Smoothed {
  Eigen::MatrixXd states;           ///< n × τ: E x(t) given all frames
  std::vector<SmootherStep> steps;  ///< the different ones
  std::vector<int> step;            ///< τ: a frame's step

  [[nodiscard]] const SmootherStep& at(Eigen::Index t) const {
    return steps[static_cast<std::size_t>(step[static_cast<std::size_t>(t)])];
  }
};

/// Smooths states backwards from the result of filter() (Rauch, Tung, Striebel 1965).
/// `filtered` must be of the same space. The cost is that of filter().
Smoothed smooth(const StateSpace& space, const Filtered& filtered);

}  // namespace emberfold::dytex
