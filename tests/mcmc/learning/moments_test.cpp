// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/moments.hpp"

#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using graph::Point;
using mcmc::Autoregression;
using mcmc::Moments;
using mcmc::Series;
using mcmc::detail::CurveTrack;

namespace {

// Straight strokes that lie still, a track at every patch; what moves is in the series alone.
struct Still {
  graph::MotionGraph motion;
  std::vector<CurveTrack> tracks;
  std::vector<std::vector<double>> along;  // of each stroke, px
};

Still still(int strokes, int patches, int frames, std::uint64_t seed) {
  Still result;
  core::Rng rng(seed, {7, 0, 0});
  test::Frame frame;
  for (int i = 0; i < strokes; ++i) {
    std::vector<Point> points;
    double s = 0;
    result.along.emplace_back();
    for (int k = 0; k < patches; ++k, s += rng.uniform(4, 6)) {
      points.push_back({s, 30.0 * i});
      result.along.back().push_back(s);
    }
    frame.line(points);
  }
  const auto graph = frame.graph();
  result.motion.sketch.width = result.motion.sketch.height = 1000;
  for (int t = 0; t < frames; ++t) result.motion.sketch.append(graph);
  result.motion.links.resize(static_cast<std::size_t>(frames));
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    CurveTrack track;
    for (int t = 0; t < frames; ++t) track.samples.push_back({graph.patch(v).position, {0, 1}, 0, 0, v});
    result.tracks.push_back(std::move(track));
  }
  return result;
}

// The motion of mcmc/model/motion_model.hpp along each stroke, its noise by the Cholesky factor of its
// correlations.
Series simulate(const Still& scene, const Autoregression& m, int frames, std::uint64_t seed) {
  Series series;
  for (std::uint32_t i = 0; i < scene.along.size(); ++i) {
    core::Rng rng(seed, {i, 0, 0});
    const auto& s = scene.along[i];
    const auto n = static_cast<Eigen::Index>(s.size());
    Eigen::MatrixXd correlation = Eigen::MatrixXd::Identity(n, n);
    for (Eigen::Index a = 0; a < n; ++a)
      for (Eigen::Index b = 0; b < a && m.range > 0; ++b)
        correlation(a, b) = correlation(b, a) = std::exp(
            -0.5 * std::pow((s[static_cast<std::size_t>(a)] - s[static_cast<std::size_t>(b)]) / m.range, 2));
    correlation.diagonal().array() += 1e-9;
    const Eigen::MatrixXd factor = correlation.llt().matrixL();
    const auto first = series.size();
    series.resize(first + s.size());
    Eigen::VectorXd now = Eigen::VectorXd::Zero(n), before = now;
    for (int t = -400; t < frames; ++t) {
      Eigen::VectorXd white(n), around(n);
      for (double& w : white) w = rng.normal();
      for (Eigen::Index k = 0; k < n; ++k)
        around[k] = k == 0 ? now[1] : k == n - 1 ? now[n - 2] : (now[k - 1] + now[k + 1]) / 2;
      const Eigen::VectorXd next =
          m.a1 * now + m.a2 * before + m.coupling * (around - now) + m.noise * (factor * white);
      before = now, now = next;
      for (Eigen::Index k = 0; t >= 0 && k < n; ++k)
        series[first + static_cast<std::size_t>(k)].push_back(now[k] + m.measurement * rng.normal());
    }
  }
  return series;
}

// Plain least squares of d(t) on d(t−1), d(t−2), straight from the series.
Eigen::Vector2d least_squares(const Series& series) {
  Eigen::Matrix2d xx = Eigen::Matrix2d::Zero();
  Eigen::Vector2d xy = Eigen::Vector2d::Zero();
  for (const auto& d : series)
    for (std::size_t t = 2; t < d.size(); ++t) {
      const Eigen::Vector2d x(d[t - 1], d[t - 2]);
      xx += x * x.transpose();
      xy += x * d[t];
    }
  return xx.inverse() * xy;
}

double deviation(const Series& series) {
  double sum = 0, count = 0;
  for (const auto& d : series)
    for (const double value : d) sum += value * value, ++count;
  return std::sqrt(sum / count);
}

constexpr auto near = [](double value, double margin) { return Catch::Matchers::WithinAbs(value, margin); };
constexpr auto about = [](double value, double share) { return Catch::Matchers::WithinRel(value, share); };

}  // namespace

TEST_CASE("The law of a simulated motion is recovered", "[moments][heavy]") {
  // a1, a2, coupling, noise, range, measurement: inert, sluggish, oscillating; long and short ranges.
  const auto truth =
      GENERATE(Autoregression{1.6, -0.7, 0, 0.3, 25, 0}, Autoregression{1.1, -0.3, 0, 1, 12, 0},
               Autoregression{1.2, -0.8, 0, 0.05, 40, 0});
  constexpr int frames = 1200;
  const auto scene = still(12, 12, frames, 1);
  const auto series = simulate(scene, truth, frames, 2);
  const auto seen = mcmc::collect_observations(scene.motion, scene.tracks, series, true);
  CHECK(seen.moments.windows == 12 * 12 * (frames - 4));
  const auto found = mcmc::estimate_motion(seen, "sway");
  CHECK(found.notes.empty());
  CAPTURE(truth.a1, truth.a2, found.motion.a1, found.motion.a2, found.motion.coupling);
  // Some 36 stretches that know nothing of each other, 1200 frames: errors of about 1/√43200 over the share
  // of the variance that is the noise's; these are five times as much.
  CHECK_THAT(found.motion.a1, near(truth.a1, 0.05));
  CHECK_THAT(found.motion.a2, near(truth.a2, 0.05));
  CHECK_THAT(found.motion.noise, about(truth.noise, 0.08));
  CHECK_THAT(found.motion.range, about(truth.range, 0.12));
  CHECK(found.motion.measurement < 0.2 * deviation(series));
  CHECK_THAT(mcmc::stationary_deviation(found.motion), about(deviation(series), 0.05));
}

TEST_CASE("Of a motion that forgets one of its roots at once the other is recovered", "[moments]") {
  // Roots 0.91 and −0.11: three frames back nothing is left of the second, and a1 and a2 trade off.
  const Autoregression truth{0.8, 0.1, 0, 1, 12, 0};
  constexpr int frames = 1200;
  const auto scene = still(12, 12, frames, 17);
  const auto series = simulate(scene, truth, frames, 18);
  const auto found =
      mcmc::estimate_motion(mcmc::collect_observations(scene.motion, scene.tracks, series, true), "sway");
  CHECK(found.notes.empty());
  CHECK_THAT(mcmc::spectral_radius(found.motion), near((0.8 + std::sqrt(0.64 + 0.4)) / 2, 0.02));
  CHECK_THAT(mcmc::stationary_deviation(found.motion), about(deviation(series), 0.05));
}

TEST_CASE("What the sketch adds to each frame alone is told from the motion", "[moments]") {
  const auto truth =
      GENERATE(Autoregression{1.5, -0.6, 0, 0.3, 25, 0.4}, Autoregression{1.6, -0.8, 0, 0.2, 20, 0.3});
  constexpr int frames = 1500;
  const auto scene = still(12, 12, frames, 3);
  const auto series = simulate(scene, truth, frames, 4);
  const auto found =
      mcmc::estimate_motion(mcmc::collect_observations(scene.motion, scene.tracks, series, true), "sway");
  CHECK(found.notes.empty());
  constexpr double margin = 0.08;
  // Plain least squares is off by more than what is allowed here.
  const Eigen::Vector2d plain = least_squares(series);
  REQUIRE(std::abs(plain[0] - truth.a1) > 2 * margin);
  CAPTURE(plain[0], plain[1], found.motion.coupling);
  CHECK_THAT(found.motion.a1, near(truth.a1, margin));
  CHECK_THAT(found.motion.a2, near(truth.a2, margin));
  CHECK_THAT(found.motion.noise, about(truth.noise, 0.15));
  CHECK_THAT(found.motion.range, about(truth.range, 0.15));
  CHECK_THAT(found.motion.measurement, about(truth.measurement, 0.15));
}

TEST_CASE("A coupling of neighbours is recovered", "[moments]") {
  const Autoregression truth{1.2, -0.4, 0.2, 0.3, 0, 0};
  constexpr int frames = 1500;
  const auto scene = still(12, 12, frames, 5);
  const auto series = simulate(scene, truth, frames, 6);
  const auto found =
      mcmc::estimate_motion(mcmc::collect_observations(scene.motion, scene.tracks, series, true), "sway");
  CHECK(found.notes.empty());
  CHECK_THAT(found.motion.a1, near(truth.a1, 0.05));
  CHECK_THAT(found.motion.a2, near(truth.a2, 0.05));
  CHECK_THAT(found.motion.coupling, near(truth.coupling, 0.05));
}

TEST_CASE("A motion that grows is drawn back and said to be", "[moments]") {
  const Autoregression truth{1.8, -1.05, 0, 0.1, 20, 0};  // each frame 2.5 % more
  const auto scene = still(6, 10, 90, 7);
  auto series = simulate(scene, {}, 90, 8);  // zeros
  for (std::size_t i = 0; i < series.size(); ++i)
    for (std::size_t t = 0; t < 90; ++t) {
      const double start = 1 + 0.1 * double(i % 10);
      series[i][t] = t == 0 ? start : t == 1 ? 0 : truth.a1 * series[i][t - 1] + truth.a2 * series[i][t - 2];
    }
  core::Rng rng(1);
  for (auto& d : series)
    for (double& value : d) value += 0.01 * rng.normal();
  const auto found =
      mcmc::estimate_motion(mcmc::collect_observations(scene.motion, scene.tracks, series, true), "sway");
  REQUIRE(found.notes.size() == 1);
  CHECK(test::contains(found.notes[0], "sway"));
  CHECK(test::contains(found.notes[0], "grows"));
  CHECK(mcmc::spectral_radius(found.motion) <= 0.995 + 1e-12);
  CHECK(mcmc::spectral_radius(found.motion) > 0.9);
  CHECK(std::isfinite(mcmc::stationary_deviation(found.motion)));
}

TEST_CASE("Too little and nothing that moves both stand still with a note", "[moments]") {
  SECTION("too few windows") {
    const auto scene = still(1, 3, 20, 9);
    const auto series = simulate(scene, {0.5, 0, 0, 1, 0, 0}, 20, 10);
    const auto seen = mcmc::collect_observations(scene.motion, scene.tracks, series, true);
    CHECK(seen.moments.windows == 3 * 16);
    const auto found = mcmc::estimate_motion(seen, "contrast");
    CHECK(found.motion == Autoregression{});
    REQUIRE(found.notes.size() == 1);
    CHECK(test::contains(found.notes[0], "contrast"));
    CHECK(test::contains(found.notes[0], "54"));
  }
  SECTION("none") {
    const auto found = mcmc::estimate_motion(mcmc::collect_observations({}, {}, {}, true), "sway");
    CHECK(found.motion == Autoregression{});
    CHECK(found.notes.size() == 1);
  }
  SECTION("constant") {
    const auto scene = still(4, 10, 60, 11);
    const Series series(40, std::vector<double>(60, 3.25));
    const auto found =
        mcmc::estimate_motion(mcmc::collect_observations(scene.motion, scene.tracks, series, true), "sway");
    CHECK(found.motion == Autoregression{});
    REQUIRE(found.notes.size() == 1);
    CHECK(test::contains(found.notes[0], "nothing moves"));
  }
}

TEST_CASE("Moments of a hand-made series", "[moments]") {
  auto scene = still(1, 1, 13, 12);
  const Series series{{1, -1, 2, -2, 3, -3, 0, 0, 0, 0, 0, 0, 0}};  // of mean 0
  const auto seen = mcmc::collect_observations(scene.motion, scene.tracks, series, true);
  const auto& sums = seen.moments;
  CHECK(sums.windows == 9);
  CHECK(sums.own(0, 0) == 9 + 9);                  // newest: 3, −3, 0 …
  CHECK(sums.own(0, 1) == -6 - 9);                 // with the one before: 3·−2, −3·3, 0·−3
  CHECK(sums.own(4, 4) == 1 + 1 + 4 + 4 + 9 + 9);  // oldest: all but the zeros
  CHECK(sums.own(0, 4) == 3 + 3);                  // 3·1, −3·−1, 0·2
  CHECK(sums.own.bottomRows(5).norm() == 0);       // no neighbours
  REQUIRE(seen.paths.size() == 1);
  CHECK(seen.paths[0].own == series[0]);
  CHECK(seen.paths[0].neighbour_mean == series[0]);
  // A track of 11 frames tells of steps but of no rest, one of 5 of nothing.
  for (const std::size_t frames : {11, 6, 5}) {
    scene.tracks[0].samples.resize(frames);
    const auto fewer =
        mcmc::collect_observations(scene.motion, scene.tracks, {std::vector<double>(frames)}, true);
    CHECK(fewer.moments.windows == 0);
    CHECK(fewer.paths.size() == (frames > 5 ? 1 : 0));
  }
}

TEST_CASE("Moments do not care for the sense of normals", "[moments]") {
  constexpr int frames = 50;
  const Autoregression law{1.3, -0.5, 0, 1, 15, 0.1};
  auto clip = still(4, 8, frames, 13);
  const auto series = simulate(clip, law, frames, 14);
  const auto all = mcmc::collect_observations(clip.motion, clip.tracks, series, true).moments;
  const auto same = [](const Moments& a, const Moments& b) {
    CHECK(a.windows == b.windows);
    CHECK((a.own - b.own).norm() < 1e-9 * b.own.norm());
    CHECK(a.pairs == b.pairs);
    for (std::size_t i = 0; i < a.products.size(); ++i) CHECK_THAT(a.products[i], near(b.products[i], 1e-6));
  };
  // Four strokes of 8 tracks: 28 pairs each in every frame, those nearer than 40 px.
  double pairs = 0;
  for (const double n : all.pairs) pairs += n;
  CHECK(pairs <= 4 * 28 * frames);
  CHECK(pairs > 4 * 25 * frames);

  auto turned = clip;
  auto signs = series;
  for (std::size_t i = 0; i < signs.size(); i += 3) {
    for (auto& sample : turned.tracks[i].samples) sample.normal = sample.normal * -1;
    for (double& value : signs[i]) value *= -1;
  }
  // ψψᵀ of a track stays when all of it changes sign.
  same(mcmc::collect_observations(turned.motion, turned.tracks, signs, true).moments, all);
  // The contrast has no side, so the sense of normals does not matter.
  same(mcmc::collect_observations(turned.motion, turned.tracks, series, false).moments, all);
}

TEST_CASE("The spectral radius is the largest eigenvalue on a ring", "[moments]") {
  // On a ring of even length the mean over neighbours has the eigenvalues 1 and −1, and those between.
  constexpr int n = 12;
  core::Rng rng(15);
  for (int trial = 0; trial < 50; ++trial) {
    const Autoregression m{rng.uniform(-2, 2), rng.uniform(-1, 1), rng.uniform(0, 0.5), 1, 0, 0};
    Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    for (int i = 0; i < n; ++i) {
      companion(i, i) = m.a1 - m.coupling;
      companion(i, (i + 1) % n) += m.coupling / 2;
      companion(i, (i + n - 1) % n) += m.coupling / 2;
      companion(i, n + i) = m.a2;
      companion(n + i, i) = 1;
    }
    const double largest =
        Eigen::EigenSolver<Eigen::MatrixXd>(companion, false).eigenvalues().cwiseAbs().maxCoeff();
    CHECK_THAT(mcmc::spectral_radius(m), about(largest, 1e-6));
  }
}

TEST_CASE("The stationary deviation is that of a long simulation", "[moments]") {
  const auto m = GENERATE(Autoregression{1.5, -0.6, 0, 0.3, 0, 0}, Autoregression{1.5, -0.6, 0.3, 0.3, 0, 0},
                          Autoregression{1.5, -0.6, 0.3, 0.3, 20, 0}, Autoregression{0.9, 0, 0.5, 2, 10, 0});
  // A ring, 5 px from patch to patch; the noise is white noise under a Gaussian window of SD range/√2.
  constexpr int n = 120, frames = 6000;
  std::vector<double> window{1};
  if (m.range > 0) {
    window.assign(n, 0);
    double power = 0;
    for (int i = 0; i < n; ++i) {
      const double h = 5.0 * std::min(i, n - i);
      window[static_cast<std::size_t>(i)] = std::exp(-h * h / (m.range * m.range));
      power += std::pow(window[static_cast<std::size_t>(i)], 2);
    }
    for (double& w : window) w /= std::sqrt(power);
  }
  core::Rng rng(16);
  std::vector<double> now(n), before(n), white(n);
  double sum = 0;
  for (int t = -500; t < frames; ++t) {
    for (double& w : white) w = rng.normal();
    std::vector<double> next(n);
    for (std::size_t i = 0; i < n; ++i) {
      double e = 0;
      for (std::size_t j = 0; j < window.size(); ++j)
        if (window[j] > 1e-9) e += window[j] * white[(i + j) % n];
      const double around = (now[(i + 1) % n] + now[(i + n - 1) % n]) / 2;
      next[i] = m.a1 * now[i] + m.a2 * before[i] + m.coupling * (around - now[i]) + m.noise * e;
      if (t >= 0) sum += next[i] * next[i] / (double(n) * frames);
    }
    before = std::exchange(now, std::move(next));
  }
  // At least 6000/10 · 600/40 independent pieces: within 1 % of the SD; four times that.
  CHECK_THAT(mcmc::stationary_deviation(m), about(std::sqrt(sum), 0.04));
}

TEST_CASE("A motion that is not stable has no stationary deviation", "[moments]") {
  CHECK_THROWS_AS(mcmc::stationary_deviation({1.2, 0, 0, 1, 0, 0}), core::InputError);
  CHECK_THROWS_AS(mcmc::stationary_deviation({2, -1, 0, 1, 0, 0}), core::InputError);
  CHECK(mcmc::stationary_deviation({0, 0, 0, 0, 0, 0}) == 0);
  CHECK_THAT(mcmc::stationary_deviation({0, 0, 0, 2, 0, 0}), near(2, 1e-9));
}
