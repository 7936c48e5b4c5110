// SPDX-License-Identifier: Apache-2.0
#include "mcmc/moments.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/LU>

namespace emberfold::mcmc {

namespace {

constexpr int K = Moments::kLags;
constexpr double most_stable = 0.995;  // spectral radius that an unstable fit is drawn back to
constexpr double fewest_windows = 100;
constexpr double bin = 5;         // px, of distances
constexpr double parallel = 0.8;  // cosine: curves that turn more say nothing of each other

// Deviations from the lineage's mean, and the neighbours' mean deviation less its own, frame by frame.
struct Deviations {
  Series own, neighbours;
};

Deviations deviations(const std::vector<detail::Lineage>& all, const detail::Neighbours& sides,
                      const Series& series, bool turns) {
  Deviations result{series, series};
  for (auto& d : result.own) {
    const double mean = std::accumulate(d.begin(), d.end(), 0.0) / static_cast<double>(d.size());
    for (double& value : d) value -= mean;
  }
  for (auto& g : result.neighbours) std::ranges::fill(g, 0.0);
  std::vector<std::vector<int>> count(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) count[i].resize(series[i].size());
  for (std::size_t t = 0; t < sides.frames.size(); ++t)
    for (const auto& [a, b, sense] : sides.frames[t]) {
      const auto at_a = t - static_cast<std::size_t>(all[a].first),
                 at_b = t - static_cast<std::size_t>(all[b].first);
      result.neighbours[a][at_a] += (turns ? sense : 1) * result.own[b][at_b];
      ++count[a][at_a];
    }
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t k = 0; k < count[i].size(); ++k)
      if (count[i][k] > 0) result.neighbours[i][k] = result.neighbours[i][k] / count[i][k] - result.own[i][k];
  return result;
}

using Window = Eigen::Matrix<double, 2 * K, 1>;

Window window(const Deviations& d, std::size_t lineage, std::size_t newest) {
  Window psi;
  for (int k = 0; k < K; ++k) {
    psi[k] = d.own[lineage][newest - static_cast<std::size_t>(k)];
    psi[K + k] = d.neighbours[lineage][newest - static_cast<std::size_t>(k)];
  }
  return psi;
}

// Coefficients of d(t) − a1 d(t−1) − a2 d(t−2) − coupling g(t−1) on a window.
Window residual(const Autoregression& m) {
  Window c = Window::Zero();
  c[0] = 1, c[1] = -m.a1, c[2] = -m.a2, c[K + 1] = -m.coupling;
  return c;
}

struct Regression {
  Eigen::VectorXd coefficients;
  bool regular = false;
};

// Two-stage least squares of ψ[0] on ψ[regressors]: with the regressors themselves as instruments it is
// plain least squares.
Regression regress(const Moments& m, const std::vector<int>& regressors,
                   const std::vector<int>& instruments) {
  const auto r = static_cast<Eigen::Index>(regressors.size()),
             s = static_cast<Eigen::Index>(instruments.size());
  Eigen::MatrixXd w(s, s), z(s, r);
  Eigen::VectorXd y(s);
  for (Eigen::Index i = 0; i < s; ++i) {
    const int row = instruments[static_cast<std::size_t>(i)];
    y[i] = m.own(row, 0);
    for (Eigen::Index j = 0; j < s; ++j) w(i, j) = m.own(row, instruments[static_cast<std::size_t>(j)]);
    for (Eigen::Index j = 0; j < r; ++j) z(i, j) = m.own(row, regressors[static_cast<std::size_t>(j)]);
  }
  const Eigen::FullPivLU<Eigen::MatrixXd> inner(w);
  if (!inner.isInvertible()) return {};
  const Eigen::MatrixXd projected = z.transpose() * inner.solve(z);
  const Eigen::FullPivLU<Eigen::MatrixXd> outer(projected);
  if (!outer.isInvertible()) return {};
  return {outer.solve(z.transpose() * inner.solve(y)), true};
}

// What the sketch adds to every frame alone: it makes neighbouring frames' residuals alike.
double measurement(const Moments& m, const Autoregression& motion) {
  const Window c = residual(motion);
  Window shifted = Window::Zero();
  for (int k = 0; k + 1 < K; ++k) shifted[k + 1] = c[k], shifted[K + k + 1] = c[K + k];
  const double lag_one = c.dot(m.own * shifted) / m.windows;
  const double loading = motion.a1 * (1 - motion.a2);
  if (std::abs(loading) < 0.1) return 0;
  return std::sqrt(std::clamp(-lag_one / loading, 0.0, 0.5 * m.own(0, 0) / m.windows));
}

// c exp(−h²/2 range²), fitted to how deviations correlate over distance.
struct Likeness {
  double share = 1, range = 0;
};
Likeness likeness(const Moments& m, double variance) {
  Likeness best;
  double least = std::numeric_limits<double>::infinity();
  for (double range = 2; range < 200; range *= 1.1) {
    double pp = 0, pc = 0, cc = 0;
    for (std::size_t i = 0; i < m.pairs.size(); ++i) {
      const double h = bin * (static_cast<double>(i) + 0.5), p = std::exp(-0.5 * h * h / (range * range));
      if (m.pairs[i] < fewest_windows) continue;
      const double c = m.products[i] / m.pairs[i] / variance;
      pp += p * p, pc += p * c, cc += c * c;
    }
    if (pp <= 0) continue;
    const double share = std::clamp(pc / pp, 0.0, 1.0), off = cc - 2 * share * pc + share * share * pp;
    if (off < least) least = off, best = {share, range};
  }
  return best;
}

// The noise that gives the deviations the variance that was measured, as far as it goes on along the curves.
void take_noise(const Moments& m, Autoregression& motion) {
  motion.measurement = measurement(m, motion);
  const double variance = m.own(0, 0) / m.windows;
  if (variance <= 0) return;
  const Likeness along = likeness(m, variance);
  motion.range = along.range;
  const double own = std::min(along.share * variance, variance - motion.measurement * motion.measurement);
  motion.noise = 1;
  motion.noise = std::sqrt(own) / stationary_deviation(motion);
}

// The frame's pairs of lineages on one stroke.
void add_pairs(Moments& sums, const graph::AttributeGraph& graph, std::size_t frame,
               const std::vector<std::uint32_t>& there, const std::vector<detail::Lineage>& all,
               const Series& deviation, bool turns) {
  const auto parts = graph::components(graph);
  std::vector<std::vector<std::uint32_t>> strokes(parts.count);
  const auto at = [&](std::uint32_t i) { return frame - static_cast<std::size_t>(all[i].first); };
  for (const auto i : there) strokes[parts.of_vertex[all[i].samples[at(i)].vertex]].push_back(i);
  for (const auto& stroke : strokes)
    for (std::size_t p = 0; p < stroke.size(); ++p)
      for (std::size_t q = 0; q < p; ++q) {
        const auto& a = all[stroke[p]].samples[at(stroke[p])];
        const auto& b = all[stroke[q]].samples[at(stroke[q])];
        const auto apart = static_cast<std::size_t>(graph::distance(a.position, b.position) / bin);
        const double facing = graph::dot(a.normal, b.normal);
        if (apart >= sums.pairs.size() || std::abs(facing) < parallel) continue;
        const double product = deviation[stroke[p]][at(stroke[p])] * deviation[stroke[q]][at(stroke[q])];
        sums.products[apart] += turns && facing < 0 ? -product : product;
        ++sums.pairs[apart];
      }
}

}  // namespace

Moments& Moments::operator+=(const Moments& other) {
  own += other.own;
  windows += other.windows;
  for (std::size_t i = 0; i < pairs.size(); ++i) products[i] += other.products[i], pairs[i] += other.pairs[i];
  return *this;
}

Moments moments(const graph::MotionGraph& motion, const std::vector<detail::Lineage>& all,
                const Series& series, bool turns, std::size_t shortest) {
  const Deviations d = deviations(all, detail::neighbours(motion, all), series, turns);
  const auto taken = [&](std::size_t i) { return d.own[i].size() >= shortest; };
  Moments sums;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t t = K - 1; taken(i) && t < d.own[i].size(); ++t) {
      const Window psi = window(d, i, t);
      sums.own += psi * psi.transpose();
      ++sums.windows;
    }
  std::vector<std::vector<std::uint32_t>> there(motion.sketch.frames.size());
  for (std::uint32_t i = 0; i < all.size(); ++i)
    for (std::size_t k = 0; taken(i) && k < all[i].samples.size(); ++k)
      there[static_cast<std::size_t>(all[i].first) + k].push_back(i);
  for (std::size_t t = 0; t < there.size(); ++t)
    add_pairs(sums, motion.sketch.frames[t], t, there[t], all, d.own, turns);
  return sums;
}

Estimate estimate(const Moments& m, const std::string& what) {
  Estimate result;
  Autoregression& motion = result.motion;
  if (m.windows < fewest_windows) {
    result.notes.push_back(what + ": too few long paths to learn a motion from (" +
                           std::to_string(static_cast<long>(m.windows)) + " windows, needed " +
                           std::to_string(static_cast<long>(fewest_windows)) + "); it stands still");
    return result;
  }
  const auto take = [&](const Regression& fit) {
    motion = {};
    motion.a1 = fit.coefficients[0], motion.a2 = fit.coefficients[1];
    if (fit.coefficients.size() > 2) motion.coupling = fit.coefficients[2];
  };
  const auto good = [&](const Regression& fit) {
    if (!fit.regular || !fit.coefficients.allFinite()) return false;
    take(fit);
    return motion.coupling >= 0 && motion.coupling < 0.5 && spectral_radius(motion) < 1;
  };
  // With coupling where that comes out sound, without it else; by plain least squares where the instruments
  // say too little.
  const Regression coupled = regress(m, {1, 2, K + 1}, {3, 4, K + 3, K + 4});
  const Regression alone = regress(m, {1, 2}, {3, 4}), plain = regress(m, {1, 2}, {1, 2});
  if (!good(coupled) && !good(alone) && !good(plain)) {
    if (!alone.regular && !plain.regular) {
      result.notes.push_back(what + ": nothing moves; it stands still");
      return {{}, result.notes};
    }
    take(plain.regular ? plain : alone);
    const double radius = spectral_radius(motion), shrink = most_stable / radius;
    motion.a1 *= shrink, motion.a2 *= shrink * shrink;
    result.notes.push_back(what + ": the fitted motion grows (spectral radius " + std::to_string(radius) +
                           "); drawn back to " + std::to_string(most_stable));
  }
  take_noise(m, motion);
  return result;
}

}  // namespace emberfold::mcmc
