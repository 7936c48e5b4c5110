// SPDX-License-Identifier: Apache-2.0
// Fits of the states' motion: closed ones, the innovations form.
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
double error_of(const detail::UnitStates& unit, const Eigen::MatrixXd& A) {
  const Eigen::MatrixXd X = unit.s.asDiagonal() * unit.V.transpose();
  return (X.rightCols(X.cols() - 1) - A * X.leftCols(X.cols() - 1)).squaredNorm();
}

}  // namespace

TEST_CASE("Under noise in the coordinates the innovations form comes nearer to the truth",
          "[dytex][dynamics]") {
  constexpr Eigen::Index n = 4, frames = 1500;
  const Eigen::MatrixXd A = turning(0.95, {0.4, 1.1});
  double least_squares = 0, subspace = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const Eigen::MatrixXd states = course(A, test::normals(n, frames, 10 + seed)),
                          seen = states + 2 * test::normals(n, frames, 20 + seed);
    const detail::UnitStates unit = test::principal_axes(seen).states;
    const detail::Dynamics closed = detail::fit_dynamics(unit, {}),
                           fit = detail::fit_dynamics(unit, with(Method::n4sid));
    REQUIRE(fit.transition == Transition::n4sid);
    least_squares += test::eigenvalue_error(closed.A, A);
    subspace += test::eigenvalue_error(fit.A, A);
    REQUIRE(fit.A.rows() == 2 * n);
    CHECK(spectral_radius(fit.A) < 1);
    // The state is (x, x̂), and each step of it the model's with an innovation that enters x.
    const Eigen::MatrixXd step = fit.states.rightCols(frames - 1) - fit.A * fit.states.leftCols(frames - 1);
    CHECK(step.bottomRows(n).norm() < 1e-8 * fit.states.norm());
    CHECK((fit.states.topRows(n) - unit.s.asDiagonal() * unit.V.transpose()).norm() <
          1e-9 * fit.states.norm());
    CHECK(fit.B.bottomRows(n).norm() == 0);
    // Drawn states vary as the observed ones.
    const Eigen::MatrixXd data = fit.states.topRows(n) * fit.states.topRows(n).transpose() / double(frames),
                          drawn = stationary_covariance(fit.A, fit.B).topLeftCorner(n, n);
    CHECK((drawn - data).norm() < 0.25 * data.norm());
    // The errors of forecasts, over all frames but the first: below least squares'.
    const Eigen::MatrixXd errors = (fit.states.topRows(n) - fit.states.bottomRows(n)).rightCols(frames - 10);
    CHECK(errors.squaredNorm() < error_of(unit, closed.A));
  }
  INFO("eigenvalues off by " << least_squares / 4 << " least squares, " << subspace / 4 << " n4sid");
  CHECK(least_squares / 4 > 0.1);
  CHECK(subspace / 4 < 0.05);
}

TEST_CASE("Without noise in the coordinates both methods agree", "[dytex][dynamics]") {
  const Eigen::MatrixXd A = turning(0.9, {0.4, 1.1});
  const detail::UnitStates unit = test::principal_axes(course(A, test::normals(4, 3000, 7))).states;
  for (const Method method : {Method::closed_form, Method::n4sid})
    CHECK(test::eigenvalue_error(detail::fit_dynamics(unit, with(method)).A, A) < 0.03);
}

TEST_CASE("Waves without noise stay undamped and keep their variance", "[dytex][dynamics]") {
  const Eigen::MatrixXd A = turning(1, {2 * std::numbers::pi / 12, 2 * std::numbers::pi / 7});
  Eigen::MatrixXd begin = Eigen::MatrixXd::Zero(4, 420);
  begin.col(0) << 30, 0, 10, 0;
  // As frames of floats round.
  const auto unit = test::principal_axes(course(A, begin).cast<float>().cast<double>()).states;
  const detail::Dynamics fit = detail::fit_dynamics(unit, {});
  CHECK(fit.transition == Transition::least_squares);
  CHECK(fit.notes.size() == 1);
  CHECK(test::eigenvalue_error(fit.A, A) < 1e-6);
  CHECK(spectral_radius(fit.A) < 1);
  const double drawn = detail::variance_within(fit.A, fit.B, 420).sum();
  CHECK(drawn == Approx(fit.states.squaredNorm() / 420).epsilon(0.02));
}

TEST_CASE("Clips too short for what is asked are refused", "[dytex][dynamics]") {
  const detail::UnitStates unit = test::principal_axes(test::normals(4, 16, 1)).states;
  const auto complaint = [&](const LearnOptions& options) {
    return test::message_of<core::InputError>([&] { detail::fit_dynamics(unit, options); });
  };
  CHECK(complaint(with(Method::n4sid)) ==
        "method: n4sid of 4 components needs at least 19 frames, the clip has 16");
}
