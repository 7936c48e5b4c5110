// SPDX-License-Identifier: Apache-2.0
// Fits of the states' motion: stable ones, longer memory, innovations forms, resampled noise.
#include "dytex/learning/dynamics.hpp"

#include <complex>
#include <numbers>

#include "core/error.hpp"
#include "dytex/learning/stable_fit.hpp"
#include "dytex/model/innovations.hpp"
#include "dytex/synthesize.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/matrices.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/reference_linalg.hpp"

using namespace emberfold;
using namespace emberfold::dytex;
using namespace emberfold::test;

namespace {

Eigen::MatrixXd turning(double radius, std::initializer_list<double> angles) {
  const auto n = static_cast<Eigen::Index>(2 * angles.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  Eigen::Index i = 0;
  for (const double angle : angles) {
    A.block<2, 2>(i, i) << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    i += 2;
  }
  return radius * A;
}

/// x(t+1) = A x(t) + drive(t).
Eigen::MatrixXd course(const Eigen::MatrixXd& A, const Eigen::MatrixXd& drive) {
  Eigen::MatrixXd states = drive;
  for (Eigen::Index t = 1; t < drive.cols(); ++t) states.col(t) += A * states.col(t - 1);
  return states;
}

LearnOptions with(Stable stable) {
  LearnOptions options;
  options.stable = stable;
  return options;
}

LearnOptions with(Method method) {
  LearnOptions options;
  options.method = method;
  return options;
}

/// ‖diag(s) (V₂ − A V₁)‖², A in levels.
double error_of(const detail::Block& block, const Eigen::MatrixXd& A) {
  const Eigen::MatrixXd X = block.s.asDiagonal() * block.V.transpose();
  return (X.rightCols(X.cols() - 1) - A * X.leftCols(X.cols() - 1)).squaredNorm();
}

/// Random walks in a short clip: least squares is often unstable.
detail::Block walks(std::uint64_t seed) {
  const Eigen::Index n = 2 + static_cast<Eigen::Index>(seed % 5), frames = 4 * n + 4;
  return test::principal_axes(course(1.05 * Eigen::MatrixXd::Identity(n, n), test::normals(n, frames, seed)))
      .block;
}

}  // namespace

TEST_CASE("The slope of the stable form is that of differences", "[dytex][dynamics]") {
  const detail::Block block = walks(3);
  const Eigen::Index n = block.s.size();
  const detail::StableObjective objective(block.s, block.V);
  const Eigen::MatrixXd S = test::normals(n, n, 1) + 3 * Eigen::MatrixXd::Identity(n, n);
  const detail::StableForm at{S, test::normals(n, n, 2), test::normals(n, n, 3)};
  const detail::StableForm slope = objective.gradient(at);
  for (const auto part : {&detail::StableForm::S, &detail::StableForm::O, &detail::StableForm::C})
    for (Eigen::Index i = 0; i < n * n; ++i) {
      constexpr double kStep = 1e-6;
      detail::StableForm high = at, low = at;
      (high.*part)(i) += kStep;
      (low.*part)(i) -= kStep;
      const double difference = (objective(high.matrix()) - objective(low.matrix())) / (2 * kStep);
      CHECK(std::abs((slope.*part)(i)-difference) < 1e-6 * (slope.*part).norm() + 1e-8);
    }
  const Eigen::MatrixXd A = at.matrix();
  const Eigen::MatrixXd in_levels = block.s.asDiagonal() * A * block.s.cwiseInverse().asDiagonal();
  CHECK_THAT(objective(A), WithinRel(error_of(block, in_levels) / (2 * block.s[0] * block.s[0]), 1e-9));
}

TEST_CASE("The best stable fit errs less than Yule-Walker's", "[dytex][dynamics]") {
  int unstable = 0;
  double excess_soc = 0, excess_yule_walker = 0;
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    const detail::Block block = walks(seed);
    const detail::Dynamics soc = detail::fit_dynamics({block}, with(Stable::soc));
    const detail::Dynamics yule_walker = detail::fit_dynamics({block}, {});
    CHECK(spectral_radius(soc.A) < 1);
    CHECK((soc.transition == Transition::soc) == (soc.least_squares_radius >= 1));
    if (soc.transition != Transition::soc) continue;
    ++unstable;
    CHECK_THAT(soc.notes.at(0), Catch::Matchers::Contains("SOC"));
    const Eigen::MatrixXd X = block.s.asDiagonal() * block.V.transpose();
    const auto gaps = X.cols() - 1;
    const Eigen::MatrixXd least =
        test::least_squares(X.leftCols(gaps).transpose(), X.rightCols(gaps).transpose()).transpose();
    const double best = error_of(block, least), soc_error = error_of(block, soc.A),
                 yule_walker_error = error_of(block, yule_walker.A);
    CHECK(soc_error >= best * (1 - 1e-9));
    CHECK(soc_error <= yule_walker_error * (1 + 1e-9));
    excess_soc += soc_error / best - 1;
    excess_yule_walker += yule_walker_error / best - 1;
  }
  INFO("mean excess: " << excess_soc / unstable << ", Yule-Walker " << excess_yule_walker / unstable);
  CHECK(unstable > 10);
  CHECK(excess_soc < 0.5 * excess_yule_walker);
}

TEST_CASE("Two lags are found again and one lag is not enough", "[dytex][dynamics]") {
  // x(t+1) = A₁ x(t) + A₂ x(t−1) + drive: with A₁ = 0 one lag sees nothing.
  constexpr Eigen::Index n = 4, frames = 3000;
  const Eigen::MatrixXd A2 = turning(0.8, {0.5, 1.3}), drive = test::normals(n, frames, 4);
  Eigen::MatrixXd states = drive;
  for (Eigen::Index t = 2; t < frames; ++t) states.col(t) += A2 * states.col(t - 2);
  const test::PrincipalAxes found = test::principal_axes(states);
  LearnOptions options;
  options.lags = 2;
  const detail::Dynamics fit = detail::fit_dynamics({found.block}, options);
  REQUIRE(fit.A.rows() == 2 * n);
  CHECK(fit.transition == Transition::least_squares);
  const Eigen::MatrixXd true_A2 = found.turn * A2 * found.turn.transpose();
  CHECK(fit.A.topLeftCorner(n, n).norm() < 0.1);
  CHECK((fit.A.topRightCorner(n, n) - true_A2).norm() < 0.1);
  CHECK(fit.A.bottomLeftCorner(n, n).isIdentity(1e-12));
  CHECK(fit.A.bottomRightCorner(n, n).norm() == 0);
  CHECK((fit.B * fit.B.transpose()).topLeftCorner(n, n).isIdentity(0.1));
  CHECK(fit.B.bottomRows(n).norm() == 0);
  const Eigen::MatrixXd X = found.block.s.asDiagonal() * found.block.V.transpose();
  CHECK((fit.states.topRows(n) - X).norm() < 1e-9 * X.norm());
  CHECK(fit.states.bottomRows(n).rightCols(frames - 1) == fit.states.topRows(n).leftCols(frames - 1));
  CHECK(detail::fit_dynamics({found.block}, {}).A.norm() < 0.2);  // one lag
}

TEST_CASE("Yule-Walker with several lags is stable and keeps the covariances", "[dytex][dynamics]") {
  int unstable = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Eigen::Index n = 2, frames = 16, lags = 2 + static_cast<Eigen::Index>(seed % 3);
    const detail::Block block =
        test::principal_axes(course(1.08 * Eigen::MatrixXd::Identity(n, n), test::normals(n, frames, seed)))
            .block;
    LearnOptions options;
    options.lags = static_cast<int>(lags);
    const detail::Dynamics fit = detail::fit_dynamics({block}, options);
    REQUIRE(spectral_radius(fit.A) < 1);
    if (fit.transition != Transition::yule_walker) continue;
    ++unstable;
    // Covariances at lags 0 … lags − 1 of the clip with zeros around it.
    const Eigen::MatrixXd X = block.s.asDiagonal() * block.V.transpose(),
                          P = stationary_covariance(fit.A, fit.B);
    for (Eigen::Index k = 0; k < lags; ++k) {
      const Eigen::MatrixXd data =
          X.rightCols(frames - k) * X.leftCols(frames - k).transpose() / double(frames);
      CHECK((P.block(0, k * n, n, n) - data).norm() < 1e-7 * X.squaredNorm() / double(frames));
    }
  }
  CHECK(unstable > 5);
}

TEST_CASE("The slope of the prediction error is that of differences", "[dytex][dynamics]") {
  constexpr Eigen::Index n = 3;
  const Eigen::MatrixXd V = test::principal_axes(test::normals(n, 30, 1)).block.V;
  Eigen::VectorXd at = 0.2 * test::normals(2 * n * n + n, 1, 2).col(0);
  const detail::PredictionError here = detail::prediction_error_at(V, at);
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    constexpr double kStep = 1e-6;
    Eigen::VectorXd high = at, low = at;
    high[i] += kStep, low[i] -= kStep;
    const double difference =
        (detail::prediction_error_at(V, high).value - detail::prediction_error_at(V, low).value) /
        (2 * kStep);
    CHECK_THAT(here.slope[i], WithinAbs(difference, 1e-6 * here.slope.norm()));
  }
  // K = A is the auto-regression: its value is that of the residuals.
  const Eigen::MatrixXd A = 0.3 * test::normals(n, n, 3);
  Eigen::VectorXd regression = Eigen::VectorXd::Zero(at.size());
  regression.segment(n * n, n * n) = A.reshaped();
  const Eigen::MatrixXd residual = V.bottomRows(29).transpose() - A * V.topRows(29).transpose();
  const double value = test::log_determinant(residual * residual.transpose() / 29);
  CHECK_THAT(detail::prediction_error_at(V, regression).value, WithinRel(value, 1e-9));
}

TEST_CASE("Under noise in the coordinates innovations forms come nearer to the truth", "[dytex][dynamics]") {
  constexpr Eigen::Index n = 4, frames = 1500;
  const Eigen::MatrixXd A = turning(0.95, {0.4, 1.1});
  double least_squares = 0, subspace = 0, prediction = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const Eigen::MatrixXd states = course(A, test::normals(n, frames, 10 + seed)),
                          seen = states + 2 * test::normals(n, frames, 20 + seed);
    const detail::Block block = test::principal_axes(seen).block;
    const detail::Dynamics closed = detail::fit_dynamics({block}, {}),
                           n4sid = detail::fit_dynamics({block}, with(Method::n4sid)),
                           pem = detail::fit_dynamics({block}, with(Method::prediction_error));
    REQUIRE(n4sid.transition == Transition::n4sid);
    REQUIRE(pem.transition == Transition::prediction_error);
    least_squares += test::eigenvalue_error(closed.A, A);
    subspace += test::eigenvalue_error(n4sid.A, A);
    prediction += test::eigenvalue_error(pem.A, A);
    for (const detail::Dynamics& fit : {n4sid, pem}) {
      REQUIRE(fit.A.rows() == 2 * n);
      CHECK(spectral_radius(fit.A) < 1);
      // The state is (x, x̂), and each step of it the model's with an innovation that enters x.
      const Eigen::MatrixXd step = fit.states.rightCols(frames - 1) - fit.A * fit.states.leftCols(frames - 1);
      CHECK(step.bottomRows(n).norm() < 1e-8 * fit.states.norm());
      CHECK((fit.states.topRows(n) - block.s.asDiagonal() * block.V.transpose()).norm() <
            1e-9 * fit.states.norm());
      CHECK(fit.B.bottomRows(n).norm() == 0);
      // Drawn states vary as the observed ones.
      const Eigen::MatrixXd data = fit.states.topRows(n) * fit.states.topRows(n).transpose() / double(frames),
                            drawn = stationary_covariance(fit.A, fit.B).topLeftCorner(n, n);
      CHECK((drawn - data).norm() < 0.25 * data.norm());
    }
    // The errors of forecasts, over all frames but the first: below least squares'.
    const auto forecast_error = [&](const detail::Dynamics& fit) {
      return (fit.states.topRows(n) - fit.states.bottomRows(n)).rightCols(frames - 10).squaredNorm();
    };
    CHECK(forecast_error(pem) < error_of(block, closed.A));
    CHECK(forecast_error(n4sid) < error_of(block, closed.A));
  }
  INFO("eigenvalues off by " << least_squares / 4 << " least squares, " << subspace / 4 << " n4sid, "
                             << prediction / 4 << " pem");
  CHECK(least_squares / 4 > 0.1);
  CHECK(subspace / 4 < 0.05);
  CHECK(prediction / 4 < 0.05);
}

TEST_CASE("Without noise in the coordinates all methods agree", "[dytex][dynamics]") {
  const Eigen::MatrixXd A = turning(0.9, {0.4, 1.1});
  const detail::Block block = test::principal_axes(course(A, test::normals(4, 3000, 7))).block;
  for (const Method method : {Method::closed_form, Method::n4sid, Method::prediction_error})
    CHECK(test::eigenvalue_error(detail::fit_dynamics({block}, with(method)).A, A) < 0.03);
}

TEST_CASE("Waves without noise stay undamped and keep their variance", "[dytex][dynamics]") {
  const Eigen::MatrixXd A = turning(1, {2 * std::numbers::pi / 12, 2 * std::numbers::pi / 7});
  Eigen::MatrixXd begin = Eigen::MatrixXd::Zero(4, 420);
  begin.col(0) << 30, 0, 10, 0;
  // As frames of floats round.
  const auto block = test::principal_axes(course(A, begin).cast<float>().cast<double>()).block;
  const detail::Dynamics fit = detail::fit_dynamics({block}, {});
  CHECK(fit.transition == Transition::least_squares);
  CHECK(fit.notes.size() == 1);
  CHECK(test::eigenvalue_error(fit.A, A) < 1e-6);
  CHECK(spectral_radius(fit.A) < 1);
  const double drawn = detail::variance_within(fit.A, fit.B, 420).sum();
  CHECK(drawn == Approx(fit.states.squaredNorm() / 420).epsilon(0.02));
}

TEST_CASE("Resampled noise keeps the moments that normal noise loses", "[dytex][dynamics]") {
  // Driven by exponential noise: skewness 2, kurtosis 9; and by normal noise beside it.
  constexpr Eigen::Index n = 2, frames = 4000;
  core::Rng rng(5);
  Eigen::MatrixXd drive(n, frames);
  for (Eigen::Index t = 0; t < frames; ++t)
    drive.col(t) << -std::log(1 - rng.uniform()) - 1, 0.5 * rng.normal();
  const test::PrincipalAxes found = test::principal_axes(course(turning(0.6, {0.8}), drive));
  LearnOptions options;
  options.noise = Noise::resampled;
  const detail::Dynamics fit = detail::fit_dynamics({found.block}, options);
  REQUIRE(fit.residuals.cols() == frames - 1);
  CHECK(fit.residuals.rowwise().mean().norm() < 1e-9);
  CHECK((fit.residuals * fit.residuals.transpose() / double(frames - 1)).isIdentity(1e-9));

  LinearDynamicTexture texture;
  texture.info = {n, 1, 1, CV_8U, 25, 255, frames};
  texture.mean = Eigen::VectorXf::Zero(n);
  texture.C = Eigen::MatrixXf::Identity(n, n);
  texture.weights = Eigen::VectorXd::Ones(n);
  texture.A = fit.A, texture.B = fit.B, texture.states = fit.states;
  texture.singular = Eigen::VectorXd::Zero(frames);
  struct Moments {
    double skewness, kurtosis;
  };
  const auto drawn = [&](const Eigen::MatrixXd& residuals) {
    texture.residuals = residuals;
    Synthesis synthesis(texture, {});
    synthesis.next();
    Eigen::VectorXd before = synthesis.state();
    Eigen::ArrayXd along(20000);  // the noise in the direction that is not normal
    for (double& x : along) {
      synthesis.next();
      x = (found.turn.transpose() * (synthesis.state() - texture.A * before))[0];
      before = synthesis.state();
    }
    along -= along.mean();
    const double variance = along.square().mean();
    return Moments{along.cube().mean() / std::pow(variance, 1.5),
                   along.square().square().mean() / variance / variance};
  };
  const Moments resampled = drawn(fit.residuals), normal = drawn({});
  CHECK_THAT(resampled.skewness, WithinAbs(2, 0.35));
  CHECK_THAT(resampled.kurtosis, WithinAbs(9, 3));
  CHECK_THAT(normal.skewness, WithinAbs(0, 0.1));
  CHECK_THAT(normal.kurtosis, WithinAbs(3, 0.2));
}

TEST_CASE("Blocks move by themselves and share the noise", "[dytex][dynamics]") {
  constexpr Eigen::Index frames = 800;
  const Eigen::MatrixXd drive = test::normals(2, frames, 1);
  const test::PrincipalAxes first = test::principal_axes(course(turning(0.9, {0.5}), drive)),
                            second = test::principal_axes(
                                course(turning(0.7, {1.5}), 0.3 * drive));  // the same noise
  std::vector<detail::Block> blocks{first.block, second.block};
  blocks[0].places = {0, 2};
  blocks[1].places = {1, 3};
  const detail::Dynamics fit = detail::fit_dynamics(blocks, {});
  const std::vector<Eigen::Index> a{0, 2}, b{1, 3};
  CHECK(fit.A(a, b).norm() == 0);
  CHECK(fit.A(b, a).norm() == 0);
  CHECK((fit.A(a, a) - detail::fit_dynamics({first.block}, {}).A).norm() < 1e-12);
  CHECK(test::eigenvalue_error(fit.A(b, b), turning(0.7, {1.5})) < 0.05);
  const Eigen::MatrixXd Q = fit.B * fit.B.transpose(),
                        shared = first.turn * (0.3 * Eigen::Matrix2d::Identity()) * second.turn.transpose();
  CHECK((Eigen::MatrixXd(Q(a, b)) - shared).norm() < 0.1 * shared.norm());
}

TEST_CASE("Clips too short for what is asked are refused", "[dytex][dynamics]") {
  const detail::Block block = test::principal_axes(test::normals(4, 16, 1)).block;
  const auto complaint = [&](const LearnOptions& options) {
    return test::message_of<core::InputError>([&] { detail::fit_dynamics({block}, options); });
  };
  LearnOptions lags;
  lags.lags = 4;
  CHECK(complaint(lags) ==
        "lags: an auto-regression of 4 components needs at least 18 frames, the clip has 16");
  CHECK(complaint(with(Method::n4sid)) ==
        "method: n4sid of 4 components needs at least 19 frames, the clip has 16");
  CHECK(complaint(with(Method::prediction_error)) ==
        "method: pem of 4 components needs at least 18 frames, the clip has 16");
}
