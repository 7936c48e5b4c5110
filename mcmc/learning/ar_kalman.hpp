// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace emberfold::mcmc::detail {

/// Holds one number for each of N laws that are evaluated side by side.
template <int N>
using Lanes = Eigen::Array<double, N, 1>;

/// Holds N laws d(t+1) = a1 d(t) + a2 d(t−1) + e of a path, with var e = `noise`.
/// A place shows d + rest with an error of variance `error`. Stable: |a2| < 1, |a1| < 1 − a2.
template <int N>
struct PathLaw {
  Lanes<N> a1, a2, noise, error;
};

/// Holds the step of a Kalman filter at the k-th place of a path; all paths share it.
/// The filter takes rests as known. The unknown rest follows by regression (de Jong 1991): the filter also
/// runs over a path of ones, and the rest is the coefficient of that path.
template <int N>
struct KalmanGain {
  Lanes<N> precision;    ///< 1 / variance of the innovation
  Lanes<N> now, before;  ///< change of d(t), d(t−1) per unit of innovation
  Lanes<N> one;          ///< innovation of a path of ones
  Lanes<N> information;  ///< of all places so far about the rest
  Lanes<N> log_scale;    ///< Σ log variance so far + log information
};

/// Computes the filter's steps for paths of up to `count` places that start in the stationary state.
template <int N>
std::vector<KalmanGain<N>> kalman_gains(const PathLaw<N>& law, std::size_t count) {
  using L = Lanes<N>;
  const L &a = law.a1, &b = law.a2;
  // Covariance of (d(t), d(t−1)) before the place is seen, at first that of an AR(2).
  L p = law.noise * (1 - b) / ((1 + b) * ((1 - b).square() - a.square())), r = p, q = p * a / (1 - b);
  L now = L::Zero(), before = L::Zero(), information = L::Zero(), logs = L::Zero();
  std::vector<KalmanGain<N>> result(count);
  for (auto& gain : result) {
    const L variance = p + law.error;
    gain.precision = variance.inverse();
    gain.now = p * gain.precision, gain.before = q * gain.precision;
    gain.one = 1 - now;
    gain.information = information += gain.one.square() * gain.precision;
    gain.log_scale = (logs += variance.log()) + information.log();
    const L u = now + gain.now * gain.one;
    now = a * u + b * (before + gain.before * gain.one), before = u;
    const L pp = law.error * gain.now, qq = law.error * gain.before, rr = r - gain.before * q;
    p = a.square() * pp + 2 * a * b * qq + b.square() * rr + law.noise, q = a * pp + b * qq, r = pp;
  }
  return result;
}

/// Filters a path whose rest is unknown, under a flat prior of the rest.
template <int N>
class RestFilter {
 public:
  explicit RestFilter(const PathLaw<N>& law) : law_(law) {}

  /// Takes the path's next place; `gain` is that of the place.
  void measure(double place, const KalmanGain<N>& gain) {
    const Lanes<N> innovation = place - now_, weighted = innovation * gain.precision;
    squares_ += innovation * weighted;
    product_ += gain.one * weighted;
    information_ = gain.information;
    now_ += gain.now * innovation, before_ += gain.before * innovation;
    one_now_ += gain.now * gain.one, one_before_ += gain.before * gain.one;
  }
  /// Advances to the next frame and adds `push` to d.
  void advance(const Lanes<N>& push) {
    step(now_, before_);
    now_ += push;
    step(one_now_, one_before_);
  }

  /// Returns Σ innovation² / variance at the most likely rest.
  [[nodiscard]] Lanes<N> squares() const { return squares_ - product_.square() / information_; }
  /// Returns the expected place, given all places so far.
  [[nodiscard]] Lanes<N> place() const { return now_ + product_ / information_ * (1 - one_now_); }
  /// Returns the variance of the next place about place(), given all places so far. `gain`: that of the next
  /// place.
  [[nodiscard]] Lanes<N> place_variance(const KalmanGain<N>& gain) const {
    return gain.precision.inverse() + gain.one.square() / information_;
  }
  /// Returns the expected deviation from rest, given all places so far.
  [[nodiscard]] Lanes<N> deviation() const { return now_ - product_ / information_ * one_now_; }

 private:
  void step(Lanes<N>& now, Lanes<N>& before) const {
    const Lanes<N> next = law_.a1 * now + law_.a2 * before;
    before = now, now = next;
  }

  PathLaw<N> law_;
  Lanes<N> now_ = Lanes<N>::Zero(), before_ = Lanes<N>::Zero();
  Lanes<N> one_now_ = Lanes<N>::Zero(), one_before_ = Lanes<N>::Zero();
  Lanes<N> squares_ = Lanes<N>::Zero(), product_ = Lanes<N>::Zero(), information_ = Lanes<N>::Zero();
};

}  // namespace emberfold::mcmc::detail
