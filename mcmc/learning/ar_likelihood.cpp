// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/ar_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/math/nelder_mead.hpp"
#include "core/parallel.hpp"
#include "mcmc/learning/ar_kalman.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::mcmc::detail {

namespace {

constexpr double freedom = 4;  // degrees of freedom of the paths' scales
constexpr int kNodes = 11;     // of the quadrature over frequencies: every half SD up to 2.5
constexpr std::size_t most_seen = 30000, first_seen = 4000;  // frames of paths
constexpr double tolerance = 0.01;  // of a log-likelihood: far less than its SD, about 1
constexpr double infinity = std::numeric_limits<double>::infinity();

Lanes<kNodes> nodes() {
  return Lanes<kNodes>::LinSpaced(kNodes, -2.5, 2.5);
}

Lanes<kNodes> log_weights() {
  const Lanes<kNodes> weights = (-0.5 * nodes().square()).exp();
  return (weights / weights.sum()).log();
}

bool oscillates(const MotionLaw& law) {
  return law.a1 * law.a1 < -4 * law.a2;
}

// a1 at each node of the frequency.
Lanes<kNodes> speeds(const MotionLaw& law) {
  const double r = std::sqrt(-law.a2), frequency = std::acos(law.a1 / (2 * r));
  return 2 * r * (frequency * (1 + law.spread * nodes())).cos();
}

template <int N>
double logarithm_of_sum(const Lanes<N>& logs) {
  if constexpr (N == 1) return logs[0];
  const double most = logs.maxCoeff();
  return most + std::log((logs - most).exp().sum());
}

// The likelihood of all paths under N laws each, of log prior `prior`.
template <int N>
double over_lanes(const std::vector<DeviationPath>& paths, const MotionLaw& law, const Lanes<N>& a1,
                  const Lanes<N>& prior) {
  std::size_t longest = 0;
  for (const auto& path : paths) longest = std::max(longest, path.own.size());
  const double q = law.noise * law.noise;
  const PathLaw<N> unit{a1 - law.coupling, Lanes<N>::Constant(law.a2), Lanes<N>::Ones(),
                        Lanes<N>::Constant(law.measurement * law.measurement / q)};
  const auto all = kalman_gains(unit, longest);
  return core::deterministic_sum(paths.size(), 16, [&](std::size_t i) {
    const DeviationPath& path = paths[i];
    const std::size_t n = path.own.size();
    if (n < 2) return 0.0;
    RestFilter<N> filter(unit);
    for (std::size_t k = 0; k < n; ++k) {
      if (k > 0) filter.advance(Lanes<N>::Constant(law.coupling * path.neighbour_mean[k - 1]));
      filter.measure(path.own[k], all[k]);
    }
    const double known = static_cast<double>(n) - 1;
    return logarithm_of_sum<N>(prior - 0.5 * all[n - 1].log_scale - 0.5 * known * std::log(q) -
                               0.5 * (freedom + known) * (1 + filter.squares() / (freedom * q)).log());
  });
}

// Takes evenly so many of the paths that they hold about `frames` frames.
std::vector<DeviationPath> evenly(const std::vector<DeviationPath>& paths, std::size_t frames) {
  std::size_t all = 0;
  for (const auto& path : paths) all += path.own.size();
  if (all <= frames) return paths;
  const double share = static_cast<double>(frames) / static_cast<double>(all);
  std::vector<DeviationPath> kept;
  for (std::size_t i = 0; i < paths.size(); ++i)
    if (std::floor(share * (double(i) + 1)) > std::floor(share * double(i))) kept.push_back(paths[i]);
  return kept;
}

// Law of a search vector; any numbers give a spectral radius of at most most_stable. Four numbers: no spread.
MotionLaw law_of(const Eigen::VectorXd& x, double coupling) {
  const double a2 = std::tanh(x[1]), a1 = std::tanh(x[0]) * (1 - a2);
  MotionLaw law;
  law.a1 = most_stable * a1, law.a2 = most_stable * most_stable * a2, law.coupling = coupling;
  law.noise = std::exp(std::clamp(x[2], -30.0, 30.0));
  law.measurement = law.noise * std::exp(std::clamp(x[3], -7.0, 7.0));
  if (x.size() > 4 && oscillates(law)) law.spread = most_spread / (1 + std::exp(-x[4]));
  return law;
}

Eigen::VectorXd numbers_of(double a1, double a2, double noise, double measurement) {
  const double b = a2 / (most_stable * most_stable);
  Eigen::VectorXd x(4);
  x << std::atanh(a1 / most_stable / (1 - b)), std::atanh(b), std::log(noise), std::log(measurement / noise);
  return x;
}

}  // namespace

double MotionLaw::mean_a1() const {
  if (spread <= 0 || !oscillates(*this)) return a1;
  return (speeds(*this) * log_weights().exp()).sum();
}

double log_likelihood(const std::vector<DeviationPath>& paths, const MotionLaw& law) {
  const Autoregression motion{law.a1, law.a2, law.coupling, 0, 0, 0};
  if (!(spectral_radius(motion) < 1) || !(law.noise > 0)) return -infinity;
  if (law.spread <= 0 || !oscillates(law))
    return over_lanes<1>(paths, law, Lanes<1>::Constant(law.a1), Lanes<1>::Zero());
  const Lanes<kNodes> a1 = speeds(law);
  for (const double a : a1)
    if (!(spectral_radius({a, law.a2, law.coupling, 0, 0, 0}) < 1)) return -infinity;
  return over_lanes<kNodes>(paths, law, a1, log_weights());
}

MotionLaw most_likely_law(const std::vector<DeviationPath>& all, double coupling, double deviation) {
  const auto paths = evenly(all, most_seen), few = evenly(paths, first_seen);
  const auto among = [&](const std::vector<DeviationPath>& some) {
    return [&some, coupling](const Eigen::VectorXd& x) { return -log_likelihood(some, law_of(x, coupling)); };
  };
  const Eigen::Vector4d steps(0.3, 0.3, 0.5, 1);
  core::detail::Minimum best{{}, infinity};
  for (const auto& [a1, a2] : {std::pair{1.85, -0.93}, {1.5, -0.7}, {1.0, -0.3}, {0.7, 0.1}})
    for (const double share : {0.1, 0.7}) {  // of the deviation, that is measurement error
      const double swing = std::sqrt((1 - a2) / ((1 + a2) * ((1 - a2) * (1 - a2) - a1 * a1)));
      const auto found = core::detail::minimize_nelder_mead(
          among(few), numbers_of(a1, a2, deviation / swing, share * deviation / swing), steps, 0.1, 150);
      if (found.value < best.value) best = found;
    }
  Eigen::VectorXd start(5), fine(5);
  start << best.at, -1;
  fine << steps / 3, 1;
  return law_of(core::detail::minimize_nelder_mead(among(paths), start, fine, tolerance, 400).at, coupling);
}

}  // namespace emberfold::mcmc::detail
