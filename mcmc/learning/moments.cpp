// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/moments.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include <Eigen/LU>

namespace emberfold::mcmc {

namespace {

constexpr int K = Moments::kLags;
constexpr std::size_t shortest_window = 12, shortest_path = 6;  // frames of tracks
constexpr double fewest = 100;                                  // steps, windows, pairs
constexpr double little = 1e-12;                                // a variance that is none
constexpr double most_swing = 1.5;  // times the variance seen, of what paths are too short to show
constexpr double bin = 5;           // px, of distances
constexpr std::size_t of_late = 4;  // frames: displacements over so long exceed the sketch's errors
constexpr double parallel = 0.8;    // cosine: curves that turn more do not count as pairs

// Deviations from the track's mean, and the neighbours' mean deviation less its own, frame by frame.
struct Deviations {
  Series own, neighbours;
};

Deviations track_deviations(const graph::MotionGraph& motion, const std::vector<detail::CurveTrack>& all,
                            const Series& series, bool turns) {
  Deviations result{series, series};
  for (auto& d : result.own) {
    const double mean = std::accumulate(d.begin(), d.end(), 0.0) / static_cast<double>(d.size());
    for (double& value : d) value -= mean;
  }
  for (auto& g : result.neighbours) std::ranges::fill(g, 0.0);
  std::vector<std::vector<int>> count(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) count[i].resize(series[i].size());
  detail::visit_track_neighbours(motion, all, [&](std::size_t t, const auto& pairs) {
    for (const auto& [a, b, sense] : pairs) {
      const auto at_a = t - static_cast<std::size_t>(all[a].first),
                 at_b = t - static_cast<std::size_t>(all[b].first);
      result.neighbours[a][at_a] += (turns ? sense : 1) * result.own[b][at_b];
      ++count[a][at_a];
    }
  });
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t k = 0; k < count[i].size(); ++k)
      if (count[i][k] > 0) result.neighbours[i][k] = result.neighbours[i][k] / count[i][k] - result.own[i][k];
  return result;
}

using Window = Eigen::Matrix<double, 2 * K, 1>;

Window window(const Deviations& d, std::size_t track, std::size_t newest) {
  Window psi;
  for (int k = 0; k < K; ++k) {
    psi[k] = d.own[track][newest - static_cast<std::size_t>(k)];
    psi[K + k] = d.neighbours[track][newest - static_cast<std::size_t>(k)];
  }
  return psi;
}

// The coupling by two-stage least squares of ψ[0] on d(t−1), d(t−2) and g(t−1).
double coupling(const Moments& m) {
  constexpr std::array<int, 3> regressors{1, 2, K + 1};
  constexpr std::array<int, 4> instruments{3, 4, K + 3, K + 4};
  Eigen::Matrix4d w;
  Eigen::Matrix<double, 4, 3> z;
  Eigen::Vector4d y;
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    y[row] = m.own(instruments[i], 0);
    for (std::size_t j = 0; j < 4; ++j) w(row, Eigen::Index(j)) = m.own(instruments[i], instruments[j]);
    for (std::size_t j = 0; j < 3; ++j) z(row, Eigen::Index(j)) = m.own(instruments[i], regressors[j]);
  }
  const Eigen::FullPivLU<Eigen::Matrix4d> inner(w);
  if (!inner.isInvertible()) return 0;
  const Eigen::FullPivLU<Eigen::Matrix3d> outer(z.transpose() * inner.solve(z));
  if (!outer.isInvertible()) return 0;
  const Eigen::Vector3d c = outer.solve(z.transpose() * inner.solve(y));
  const bool sound =
      c.allFinite() && c[2] > 0 && c[2] < 0.5 && spectral_radius({c[0], c[1], c[2], 0, 0, 0}) < 1;
  return sound ? c[2] : 0;
}

// c exp(−h²/2 range²), fitted to the correlation of deviations over distance.
struct CorrelationFit {
  double share = 1, range = 0;
};
CorrelationFit fit_correlation(const Moments& m) {
  CorrelationFit best;
  double least = std::numeric_limits<double>::infinity();
  for (double range = 2; range < 200; range *= 1.1) {
    double pp = 0, pc = 0, cc = 0;
    for (std::size_t i = 0; i < m.pairs.size(); ++i) {
      const double h = bin * (static_cast<double>(i) + 0.5), p = std::exp(-0.5 * h * h / (range * range));
      if (m.pairs[i] < fewest || m.squares[i] <= little) continue;
      const double c = m.products[i] / m.squares[i];
      pp += p * p, pc += p * c, cc += c * c;
    }
    if (pp <= 0) continue;
    const double share = std::clamp(pc / pp, 0.0, 1.0), off = cc - 2 * share * pc + share * share * pp;
    if (off < least) least = off, best = {share, range};
  }
  return best;
}

// Share of the stationary variance that lies about the mean of n frames, for each n.
std::vector<double> share_about_mean(const Autoregression& m, double error_share, std::size_t longest) {
  std::vector<double> shares{1, 0};
  double before = 1, now = m.a1 / (1 - m.a2), sum = 0, weighted = 0;  // correlations, Σ ρ(k), Σ k ρ(k)
  for (std::size_t n = 2; n <= longest; ++n) {
    sum += now, weighted += (static_cast<double>(n) - 1) * now;
    before = std::exchange(now, m.a1 * now + m.a2 * before);
    const auto frames = static_cast<double>(n);
    const double mean = (frames + 2 * (frames * sum - weighted)) / (frames * frames);
    shares.push_back(1 - (1 - error_share) * mean - error_share / frames);
  }
  return shares;
}

// The variance of all deviations from rest, computed from those from the paths' means.
double variance_about_rest(const std::vector<detail::DeviationPath>& paths, const Autoregression& m,
                           double error_share) {
  std::size_t longest = 0;
  for (const auto& path : paths) longest = std::max(longest, path.own.size());
  const auto shares = share_about_mean(m, error_share, longest);
  RobustVariance all;
  for (const auto& path : paths) {
    const double share = std::max(shares[path.own.size()], 1 / most_swing);
    for (const double d : path.own) all.add(d / std::sqrt(share));
  }
  return all.value();
}

// Sets noise and measurement from all paths' mean variance. The noise gets the part that is shared along the
// curves.
void set_noise(const MotionObservations& seen, const detail::MotionLaw& law, Autoregression& motion) {
  motion.noise = law.noise;
  const double swing = std::pow(stationary_deviation(motion), 2), error = std::pow(law.measurement, 2);
  const double error_share = error / (swing + error);
  const double all = variance_about_rest(seen.paths, motion, error_share);
  const CorrelationFit along = fit_correlation(seen.moments);
  motion.range = along.range;
  motion.measurement = std::sqrt(error_share * all);
  motion.noise *= std::sqrt(all * std::min(along.share, 1 - error_share) / swing);
}

// Adds the frame's pairs of tracks on one stroke, by their displacements over the last frames. Means of
// tracks that begin and end at different times would not be comparable.
void add_pairs(Moments& sums, const graph::AttributeGraph& graph, std::size_t frame,
               const std::vector<std::uint32_t>& there, const std::vector<detail::CurveTrack>& all,
               const Series& deviation, bool turns) {
  const auto parts = graph::components(graph);
  std::vector<std::vector<std::uint32_t>> by_stroke(parts.count);
  const auto at = [&](std::uint32_t i) { return frame - static_cast<std::size_t>(all[i].first); };
  for (const auto i : there)
    if (at(i) >= of_late) by_stroke[parts.of_vertex[all[i].samples[at(i)].vertex]].push_back(i);
  const auto moved = [&](std::uint32_t i) { return deviation[i][at(i)] - deviation[i][at(i) - of_late]; };
  for (const auto& stroke : by_stroke)
    for (std::size_t p = 0; p < stroke.size(); ++p)
      for (std::size_t q = 0; q < p; ++q) {
        const auto& a = all[stroke[p]].samples[at(stroke[p])];
        const auto& b = all[stroke[q]].samples[at(stroke[q])];
        const auto apart = static_cast<std::size_t>(graph::distance(a.position, b.position) / bin);
        const double facing = graph::dot(a.normal, b.normal);
        if (apart >= sums.pairs.size() || std::abs(facing) < parallel) continue;
        const double one = moved(stroke[p]),
                     other = turns && facing < 0 ? -moved(stroke[q]) : moved(stroke[q]);
        sums.products[apart] += one * other;
        sums.squares[apart] += (one * one + other * other) / 2;
        ++sums.pairs[apart];
      }
}

}  // namespace

MotionObservations collect_observations(const graph::MotionGraph& motion,
                                        const std::vector<detail::CurveTrack>& all, const Series& series,
                                        bool turns) {
  const Deviations d = track_deviations(motion, all, series, turns);
  const auto tells_rest = [&](std::size_t i) { return d.own[i].size() >= shortest_window; };
  MotionObservations seen;
  Moments& sums = seen.moments;
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    for (std::size_t t = K - 1; tells_rest(i) && t < d.own[i].size(); ++t) {
      const Window psi = window(d, i, t);
      sums.own += psi * psi.transpose();
      ++sums.windows;
    }
    if (d.own[i].size() < shortest_path) continue;
    detail::DeviationPath path{d.own[i], d.own[i]};
    for (std::size_t k = 0; k < path.neighbour_mean.size(); ++k) path.neighbour_mean[k] += d.neighbours[i][k];
    seen.paths.push_back(std::move(path));
  }
  const auto& frames = motion.sketch.frames;
  detail::visit_frames(all, frames.size(), [&](std::size_t t, std::span<const std::uint32_t> there) {
    std::vector<std::uint32_t> resting;
    std::ranges::copy_if(there, std::back_inserter(resting), tells_rest);
    add_pairs(sums, frames[t], t, resting, all, d.own, turns);
  });
  return seen;
}

MotionEstimate estimate_motion(const MotionObservations& seen, const std::string& what) {
  MotionEstimate result;
  double steps = 0, squares = 0, count = 0;
  for (const auto& path : seen.paths) {
    steps += static_cast<double>(path.own.size()) - 2, count += static_cast<double>(path.own.size());
    for (const double d : path.own) squares += d * d;
  }
  if (steps < fewest) {
    result.notes.push_back(what + ": too few long paths to learn a motion from (" +
                           std::to_string(static_cast<long>(steps)) + " steps, needed " +
                           std::to_string(static_cast<long>(fewest)) + "); it stands still");
    return result;
  }
  if (squares / count <= little) {
    result.notes.push_back(what + ": nothing moves; it stands still");
    return result;
  }
  const auto law = detail::most_likely_law(seen.paths, coupling(seen.moments), std::sqrt(squares / count));
  result.law = law;
  result.motion = {law.mean_a1(), law.a2, law.coupling, 0, 0, 0};
  if (const double radius = spectral_radius({law.a1, law.a2, law.coupling, 0, 0, 0});
      radius > detail::most_stable - 1e-4)
    result.notes.push_back(
        what + ": the likeliest motion grows or never comes to rest; held at a spectral radius of " +
        std::to_string(radius));
  set_noise(seen, law, result.motion);
  return result;
}

}  // namespace emberfold::mcmc
