// SPDX-License-Identifier: Apache-2.0
// Fits of the states' motion: stable ones, longer memory, innovations forms.
#include "dytex/learning/dynamics.hpp"

#include <complex>
#include <numbers>

#include "core/error.hpp"
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

}  // namespace

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

TEST_CASE("Under noise in the coordinates the innovations form comes nearer to the truth",
          "[dytex][dynamics]") {
  constexpr Eigen::Index n = 4, frames = 1500;
  const Eigen::MatrixXd A = turning(0.95, {0.4, 1.1});
  double least_squares = 0, subspace = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const Eigen::MatrixXd states = course(A, test::normals(n, frames, 10 + seed)),
                          seen = states + 2 * test::normals(n, frames, 20 + seed);
    const detail::Block block = test::principal_axes(seen).block;
    const detail::Dynamics closed = detail::fit_dynamics({block}, {}),
                           fit = detail::fit_dynamics({block}, with(Method::n4sid));
    REQUIRE(fit.transition == Transition::n4sid);
    least_squares += test::eigenvalue_error(closed.A, A);
    subspace += test::eigenvalue_error(fit.A, A);
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
    // The errors of forecasts, over all frames but the first: below least squares'.
    const Eigen::MatrixXd errors = (fit.states.topRows(n) - fit.states.bottomRows(n)).rightCols(frames - 10);
    CHECK(errors.squaredNorm() < error_of(block, closed.A));
  }
  INFO("eigenvalues off by " << least_squares / 4 << " least squares, " << subspace / 4 << " n4sid");
  CHECK(least_squares / 4 > 0.1);
  CHECK(subspace / 4 < 0.05);
}

TEST_CASE("Without noise in the coordinates both methods agree", "[dytex][dynamics]") {
  const Eigen::MatrixXd A = turning(0.9, {0.4, 1.1});
  const detail::Block block = test::principal_axes(course(A, test::normals(4, 3000, 7))).block;
  for (const Method method : {Method::closed_form, Method::n4sid})
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
}
