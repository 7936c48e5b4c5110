// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/ar_likelihood.hpp"

#include <cmath>

#include <Eigen/Cholesky>

#include "core/parallel.hpp"
#include "core/rng.hpp"
#include "mcmc/learning/ar_kalman.hpp"
#include "mcmc/learning/drift.hpp"
#include "mcmc/learning/moments.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/motion_scene.hpp"

using namespace emberfold;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using mcmc::detail::DeviationPath;
using mcmc::detail::MotionLaw;

namespace {

constexpr auto near = [](double value, double margin) { return Catch::Matchers::WithinAbs(value, margin); };
constexpr auto about = [](double value, double share) { return Catch::Matchers::WithinRel(value, share); };

// Covariance of an AR(2) seen with an error, its noise of variance 1.
MatrixXd covariance(double a1, double a2, double error, Eigen::Index n) {
  VectorXd c(std::max<Eigen::Index>(n, 2));
  c[0] = (1 - a2) / ((1 + a2) * ((1 - a2) * (1 - a2) - a1 * a1)), c[1] = c[0] * a1 / (1 - a2);
  for (Eigen::Index k = 2; k < n; ++k) c[k] = a1 * c[k - 1] + a2 * c[k - 2];
  MatrixXd m(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) m(i, j) = c[std::abs(i - j)] + (i == j ? error : 0);
  return m;
}

// The restricted likelihood of a path by its whole covariance matrix, under an inverse Gamma law of its scale
// of four degrees of freedom.
double dense(const DeviationPath& path, const MotionLaw& law, double a1) {
  const auto n = static_cast<Eigen::Index>(path.own.size());
  const double own = a1 - law.coupling, q = law.noise * law.noise;
  VectorXd y(n);
  double pushed = 0, before = 0;  // what the neighbours alone make of it
  for (Eigen::Index t = 0; t < n; ++t) {
    const auto k = static_cast<std::size_t>(t);
    if (t > 0)
      pushed =
          own * pushed + law.a2 * std::exchange(before, pushed) + law.coupling * path.neighbour_mean[k - 1];
    y[t] = path.own[k] - pushed;
  }
  const MatrixXd c = covariance(own, law.a2, std::pow(law.measurement / law.noise, 2), n);
  const Eigen::LLT<MatrixXd> factor(c);
  const VectorXd one = VectorXd::Ones(n), weights = factor.solve(one);
  const double information = one.dot(weights), rest = weights.dot(y) / information;
  const VectorXd off = y - rest * one;
  const double squares = off.dot(factor.solve(off)), known = double(n) - 1;
  const double log_det = 2 * MatrixXd(factor.matrixL()).diagonal().array().log().sum();
  return -0.5 * (log_det + std::log(information) + known * std::log(q)) -
         0.5 * (4 + known) * std::log(1 + squares / (4 * q));
}

std::vector<DeviationPath> random_paths(std::uint64_t seed) {
  core::Rng rng(seed);
  std::vector<DeviationPath> paths;
  for (const std::size_t n : {2, 3, 7, 12, 40, 20, 9, 6, 15, 8, 11, 5, 31, 10, 13, 17, 6, 21}) {
    DeviationPath path;
    for (std::size_t k = 0; k < n; ++k)
      path.own.push_back(3 + rng.normal()), path.neighbour_mean.push_back(rng.normal());
    paths.push_back(path);
  }
  return paths;
}

// Paths of `law` about rests far off, each of its own frequency; `scale` by path.
struct Lives {
  int count = 400, shortest = 15, longest = 30;
  double spread = 0;
};
std::vector<DeviationPath> simulate(const MotionLaw& law, const Lives& lives, std::uint64_t seed) {
  std::vector<DeviationPath> paths;
  const double r = std::sqrt(std::max(0.0, -law.a2)), frequency = r > 0 ? std::acos(law.a1 / (2 * r)) : 0;
  for (int i = 0; i < lives.count; ++i) {
    core::Rng rng(seed, {static_cast<std::uint32_t>(i), 0, 0});
    const double a1 =
        lives.spread > 0 ? 2 * r * std::cos(frequency * (1 + lives.spread * rng.normal())) : law.a1;
    const auto n =
        static_cast<std::size_t>(lives.shortest + rng.uniform(0, 1) * (lives.longest - lives.shortest + 1));
    DeviationPath path;
    double now = 0, before = 0, mean = 0;
    for (int t = -300; t < static_cast<int>(n); ++t) {
      now = a1 * now + law.a2 * std::exchange(before, now) + law.noise * rng.normal();
      if (t >= 0) path.own.push_back(now + law.measurement * rng.normal());
    }
    for (const double d : path.own) mean += d / static_cast<double>(n);
    for (double& d : path.own) d -= mean;
    path.neighbour_mean = path.own;
    paths.push_back(path);
  }
  return paths;
}

double deviation(const std::vector<DeviationPath>& paths) {
  double squares = 0, count = 0;
  for (const auto& path : paths)
    for (const double d : path.own) squares += d * d, ++count;
  return std::sqrt(squares / count);
}

MotionLaw most_likely_law(const std::vector<DeviationPath>& paths) {
  return mcmc::detail::most_likely_law(paths, 0, deviation(paths));
}

// Plain least squares of d(t) on d(t−1), d(t−2).
Eigen::Vector2d least_squares(const std::vector<DeviationPath>& paths) {
  Eigen::Matrix2d xx = Eigen::Matrix2d::Zero();
  Eigen::Vector2d xy = Eigen::Vector2d::Zero();
  for (const auto& path : paths)
    for (std::size_t t = 2; t < path.own.size(); ++t) {
      const Eigen::Vector2d x(path.own[t - 1], path.own[t - 2]);
      xx += x * x.transpose(), xy += x * path.own[t];
    }
  return xx.llt().solve(xy);
}

}  // namespace

TEST_CASE("A likelihood is that of the whole covariance matrix", "[likelihood]") {
  const auto law = GENERATE(MotionLaw{1.6, -0.8, 0, 0.7, 0.4, 0}, MotionLaw{0.9, 0.05, 0, 1.5, 0, 0},
                            MotionLaw{1.2, -0.5, 0.2, 0.3, 1, 0}, MotionLaw{-0.3, 0.2, 0.1, 1, 0.2, 0});
  const auto paths = random_paths(1);
  double expected = 0;
  for (const auto& path : paths) expected += dense(path, law, law.a1);
  CHECK_THAT(mcmc::detail::log_likelihood(paths, law), near(expected, 1e-8 * std::abs(expected)));
}

TEST_CASE("Frequencies that differ between paths are integrated out", "[likelihood]") {
  const MotionLaw law{1.6, -0.85, 0, 0.8, 0.3, 0.15};
  const double r = std::sqrt(0.85), frequency = std::acos(1.6 / (2 * r));
  const auto paths = random_paths(2);
  // A quadrature forty times as fine over a normal law cut where the coarse one's cells end.
  double expected = 0, mean = 0, mass = 0;
  constexpr int steps = 440;
  std::vector<double> sums(paths.size());
  for (int i = 0; i < steps; ++i) {
    const double x = -2.75 + 5.5 * (i + 0.5) / steps, w = std::exp(-0.5 * x * x);
    const double a1 = 2 * r * std::cos(frequency * (1 + law.spread * x));
    for (std::size_t p = 0; p < paths.size(); ++p) sums[p] += w * std::exp(dense(paths[p], law, a1));
    mass += w, mean += w * a1;
  }
  for (const double sum : sums) expected += std::log(sum / mass);
  CHECK_THAT(mcmc::detail::log_likelihood(paths, law), near(expected, 0.05));
  CHECK_THAT(law.mean_a1(), near(mean / mass, 1e-3));
  CHECK(law.mean_a1() < law.a1);
}

TEST_CASE("A path's expected place is the best linear prediction", "[likelihood]") {
  constexpr double a1 = 1.5, a2 = -0.7, noise = 0.4, error = 0.3;
  const auto lane = [](double v) { return mcmc::detail::Lanes<1>::Constant(v); };
  const mcmc::detail::PathLaw<1> law{lane(a1), lane(a2), lane(noise), lane(error)};
  const auto gains = mcmc::detail::kalman_gains(law, 12);
  mcmc::detail::RestFilter<1> filter(law);
  core::Rng rng(3);
  VectorXd y(13);
  for (Eigen::Index n = 1; n <= 12; ++n) {
    y[n - 1] = 40 + rng.normal();
    filter.measure(y[n - 1], gains[static_cast<std::size_t>(n) - 1]);
    filter.advance(lane(0));
    // Universal kriging: the next place from those before, the mean unknown.
    const MatrixXd all = noise * covariance(a1, a2, error / noise, n + 1);
    const Eigen::LLT<MatrixXd> factor(all.topLeftCorner(n, n));
    const VectorXd one = VectorXd::Ones(n), seen = y.head(n), to_next = all.col(n).head(n);
    const double rest = one.dot(factor.solve(seen)) / one.dot(factor.solve(one));
    const double expected = rest + to_next.dot(factor.solve(seen - rest * one));
    CHECK_THAT(filter.place()[0], near(expected, 1e-9));
  }
}

TEST_CASE("A law that is not stable has no likelihood", "[likelihood]") {
  const auto paths = random_paths(4);
  for (const MotionLaw& law : {MotionLaw{1.2, 0, 0, 1, 0, 0}, MotionLaw{2, -1, 0, 1, 0, 0},
                               MotionLaw{-0.9, 0, 0.4, 1, 0, 0}, MotionLaw{1, 0, 0, 0, 1, 0}})
    CHECK(mcmc::detail::log_likelihood(paths, law) == -std::numeric_limits<double>::infinity());
}

TEST_CASE("Short paths tell their law where least squares about their means is biased", "[likelihood]") {
  const auto truth =
      GENERATE(MotionLaw{1.66, -0.94, 0, 0.35, 0.1, 0}, MotionLaw{1.85, -0.96, 0, 0.12, 0.1, 0},
               MotionLaw{1.93, -0.97, 0, 0.13, 0.1, 0});
  const auto paths = simulate(truth, {}, 5);
  const Eigen::Vector2d plain = least_squares(paths);
  const auto found = most_likely_law(paths);
  CAPTURE(truth.a1, truth.a2, plain[0], plain[1], found.a1, found.a2, found.noise, found.measurement);
  REQUIRE(std::abs(plain[1] / truth.a2 - 1) > 0.02);
  CHECK_THAT(found.mean_a1(), about(truth.a1, 0.01));
  CHECK_THAT(found.a2, about(truth.a2, 0.015));
  CHECK_THAT(found.noise, about(truth.noise, 0.08));
  CHECK_THAT(found.measurement, near(truth.measurement, 0.3 * truth.measurement));
  CHECK(found.spread < 0.1);
}

TEST_CASE("Paths of unlike frequencies are not taken for damped ones", "[likelihood]") {
  const MotionLaw truth{1.7, -0.94, 0, 0.35, 0.1, 0};
  constexpr double spread = 0.16;
  const auto paths = simulate(truth, {600, 15, 60, spread}, 6);
  const auto found = most_likely_law(paths);
  CAPTURE(found.a1, found.a2, found.spread);
  // The likeliest law of one frequency for all is more damped.
  double a2_of_one = 0, most = -1e300;
  for (double a2 = -0.98; a2 < -0.8; a2 += 0.01)
    for (double a1 = 1.55; a1 < 1.8; a1 += 0.02)
      if (const double value =
              mcmc::detail::log_likelihood(paths, {a1, a2, 0, found.noise, found.measurement, 0});
          value > most)
        most = value, a2_of_one = a2;
  REQUIRE(a2_of_one > -0.93);
  CHECK_THAT(found.a2, about(truth.a2, 0.012));
  CHECK_THAT(found.a1, about(truth.a1, 0.012));
  CHECK_THAT(found.spread, about(spread, 0.2));
}

TEST_CASE("A few paths gone astray hardly change the law", "[likelihood]") {
  const MotionLaw truth{1.8, -0.95, 0, 0.2, 0.1, 0};
  auto paths = simulate(truth, {}, 7);
  core::Rng rng(8);
  for (std::size_t i = 0; i < paths.size(); i += 20) {  // they hop to another curve and back
    auto& own = paths[i].own;
    for (double& d : own)
      if (rng.uniform() < 0.3) d += 12;
  }
  const auto found = most_likely_law(paths);
  REQUIRE(std::abs(least_squares(paths)[1] / truth.a2 - 1) > 0.2);
  CHECK_THAT(found.mean_a1(), about(truth.a1, 0.03));
  CHECK_THAT(found.a2, about(truth.a2, 0.04));
}

TEST_CASE("The likeliest law is the same at any thread count", "[likelihood]") {
  const auto paths = simulate({1.7, -0.9, 0, 0.3, 0.1, 0}, {120, 10, 30, 0.1}, 9);
  const auto many = most_likely_law(paths);
  const core::ThreadLimit one(1);
  const auto alone = most_likely_law(paths);
  CHECK(many.a1 == alone.a1);
  CHECK(many.a2 == alone.a2);
  CHECK(many.noise == alone.noise);
  CHECK(many.measurement == alone.measurement);
  CHECK(many.spread == alone.spread);
}

TEST_CASE("The sway of strokes that live for 15 to 30 frames is found", "[likelihood][slow]") {
  const auto law = GENERATE(test::Law{1.66, -0.94, 0.35, 30}, test::Law{1.85, -0.96, 0.12, 30});
  test::Scene scene;
  scene.frames = 100;
  scene.jitter = 0.1;
  scene.displacement = law;
  core::Rng rng(10);
  for (int born = -20; born < scene.frames; born += 15)
    for (auto stroke : test::scattered(6, 4, scene.width, scene.height, 50)) {
      stroke.born = std::max(0, born + static_cast<int>(rng.uniform(0, 5)));
      stroke.dies = stroke.born + static_cast<int>(rng.uniform(15, 31));
      // Apart from those before them.
      stroke.start = stroke.start + test::Point{rng.uniform(-14, 14), rng.uniform(-14, 14)};
      scene.strokes.push_back(stroke);
    }
  const auto truth = test::make(scene, 11);
  const auto tracks = mcmc::detail::track_curves(truth.motion);
  mcmc::Series normal_displacement;
  for (const auto& track : tracks) {
    normal_displacement.emplace_back();
    for (const auto& sample : track.samples) normal_displacement.back().push_back(sample.normal_displacement);
  }
  const auto found = mcmc::estimate_motion(
      mcmc::collect_observations(truth.motion, tracks, normal_displacement, true), "sway");
  CAPTURE(found.motion.a1, found.motion.a2, found.motion.noise, found.motion.measurement);
  CHECK(found.notes.empty());
  CHECK_THAT(found.motion.a1, about(law.a1, 0.02));
  CHECK_THAT(found.motion.a2, about(law.a2, 0.03));
  CHECK_THAT(mcmc::stationary_deviation(found.motion), about(law.deviation(), 0.12));
}
