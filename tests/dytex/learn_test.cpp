// SPDX-License-Identifier: Apache-2.0
// Learned models, compared with known systems and with the definitions.
#include "dytex/learn.hpp"

#include <algorithm>
#include <array>
#include <complex>
#include <numbers>

#include "core/error.hpp"
#include "dytex/learning/dynamics.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/matrices.hpp"
#include "tests/support/reference_linalg.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

dytex::LearnResult learn(const core::Clip& clip, int n) {
  core::ClipSource source(clip);
  return dytex::learn(source, {.components = n, .energy = {}});
}

/// Two rotations that fade, scaled so that the states' variances fall from one to the next.
Eigen::MatrixXd rotations() {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(4, 4);
  const std::array<std::pair<double, double>, 2> turns{{{0.95, 0.4}, {0.9, 1.1}}};
  for (int i = 0; i < 2; ++i) {
    const auto [size, angle] = turns[static_cast<std::size_t>(i)];
    A.block<2, 2>(2 * i, 2 * i) << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    A.block<2, 2>(2 * i, 2 * i) *= size;
  }
  return A;
}

std::vector<std::complex<double>> by_argument(const Eigen::MatrixXd& matrix) {
  const Eigen::VectorXcd values = test::eigenvalues(matrix);
  std::vector<std::complex<double>> result(values.begin(), values.end());
  std::sort(result.begin(), result.end(), [](auto a, auto b) { return std::arg(a) < std::arg(b); });
  return result;
}

}  // namespace

TEST_CASE("A known system is found again", "[dytex][learn]") {
  constexpr Eigen::Index m = 400, n = 4, frames = 1000;
  const Eigen::MatrixXd A = rotations(), C = test::orthonormal(m, n, 1);
  const Eigen::VectorXd strength = Eigen::Vector4d(120, 90, 60, 45);
  const Eigen::MatrixXd drive = strength.asDiagonal() * test::normals(n, frames, 2);
  Eigen::MatrixXd states(n, frames);
  states.col(0).setZero();
  for (Eigen::Index t = 1; t < frames; ++t) states.col(t) = A * states.col(t - 1) + drive.col(t);
  const double r = 4;
  const Eigen::MatrixXd levels =
      ((C * states + std::sqrt(r) * test::normals(m, frames, 3)).array() + 128).matrix();
  const dytex::LearnResult result = learn(test::clip_of(levels, 20, 20, 1, CV_32F), 4);
  const dytex::LinearDynamicTexture& found = result.texture;
  CHECK(result.transition == dytex::Transition::least_squares);
  CHECK(result.notes.empty());
  CHECK(result.passes == 1);

  const auto truth = by_argument(A), learned = by_argument(found.A);
  for (std::size_t i = 0; i < truth.size(); ++i) CHECK(std::abs(truth[i] - learned[i]) < 0.04);
  const Eigen::MatrixXd turn = found.C.cast<double>().transpose() * C;  // from the true states to the learned
  CHECK(test::singular_values(turn).minCoeff() > 0.999);
  const Eigen::MatrixXd Q = turn * strength.cwiseAbs2().asDiagonal() * turn.transpose();
  CHECK((found.B * found.B.transpose() - Q).norm() < 0.12 * Q.norm());
  CHECK_THAT(found.r, WithinRel(r, 0.01));  // 400 000 values: an SD of 0.22 %
}

TEST_CASE("The variance left counts degrees of freedom", "[dytex][learn]") {
  const Eigen::MatrixXd noise = (5 * test::normals(3000, 40, 5).array() + 128).matrix();
  CHECK_THAT(
      learn(test::clip_of(noise, 60, 50, 1, CV_32F), 20).texture.r,
      WithinRel(25 * 0.93, 0.08));  // the largest 20 of 39 noise directions hold somewhat more than half
}

TEST_CASE("What is learned fulfils the definitions", "[dytex][learn]") {
  const int n = 8;
  for (const int depth : {CV_8U, CV_16U, CV_32F}) {
    for (const int channels : {1, 3}) {
      const core::Clip clip = test::wavy_clip(31, 17, channels, depth, 60);
      const dytex::LearnResult result = learn(clip, n);
      const dytex::LinearDynamicTexture& texture = result.texture;
      REQUIRE_NOTHROW(dytex::validate(texture));
      CHECK(texture.info == clip.info);
      INFO("depth " << depth << ", channels " << channels);
      const Eigen::MatrixXd Y = test::levels_of(clip);
      const Eigen::VectorXd mean = Y.rowwise().mean();
      const Eigen::MatrixXd centred = Y.colwise() - mean;
      const test::ThinSvd svd = test::thin_svd(centred);
      const Eigen::MatrixXd C = texture.C.cast<double>();
      CHECK((texture.mean.cast<double>() - mean).cwiseAbs().maxCoeff() < 2e-5);
      CHECK((texture.singular - svd.s).head(59).norm() < 1e-8 * svd.s[0]);
      CHECK((C.transpose() * C - Eigen::MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff() < 1e-6);
      CHECK((C * C.transpose() - svd.U.leftCols(n) * svd.U.leftCols(n).transpose()).norm() < 1e-4);
      CHECK((texture.states - C.transpose() * centred).norm() < 1e-5 * texture.states.norm());
      const double left = (centred - C * texture.states).squaredNorm();
      const auto m = static_cast<double>(Y.rows());
      CHECK_THAT(texture.r, WithinRel(left / ((m - n) * (59 - n)), 1e-5));
      // A and Q by the normal equations.
      REQUIRE(result.transition == dytex::Transition::least_squares);
      const Eigen::MatrixXd before = texture.states.leftCols(59), after = texture.states.rightCols(59);
      const Eigen::MatrixXd A =
          test::solve_positive(before * before.transpose(), before * after.transpose()).transpose();
      CHECK((texture.A - A).norm() < 1e-9 * A.norm());
      const Eigen::MatrixXd E = after - A * before, Q = E * E.transpose() / 59;
      CHECK((texture.B * texture.B.transpose() - Q).norm() < 1e-9 * Q.norm());
      CHECK_THAT(result.least_squares_radius, WithinAbs(dytex::spectral_radius(A), 1e-9));
    }
  }
}

TEST_CASE("Of depths that show the same the models are the same", "[dytex][learn]") {
  const core::Clip bytes = test::wavy_clip(16, 12, 1, CV_8U, 30);
  const Eigen::MatrixXd levels = test::levels_of(bytes);
  const dytex::LinearDynamicTexture of_bytes = learn(bytes, 5).texture;
  for (const int depth : {CV_16U, CV_32F}) {
    const dytex::LinearDynamicTexture other = learn(test::clip_of(levels, 16, 12, 1, depth), 5).texture;
    CHECK((other.mean - of_bytes.mean).norm() < 1e-4F);
    CHECK((other.C - of_bytes.C).norm() < 1e-4F);
    CHECK((other.A - of_bytes.A).norm() < 1e-4);
    CHECK_THAT(other.r, WithinRel(of_bytes.r, 1e-4));
  }
}

TEST_CASE("Where least squares is not stable Yule-Walker is taken and keeps the covariance",
          "[dytex][learn]") {
  const dytex::LearnResult result = learn(test::flaring_clip(0.1), 2);
  CHECK(result.least_squares_radius >= 1);
  CHECK(result.transition == dytex::Transition::yule_walker);
  REQUIRE(result.notes.size() == 2);
  CHECK_THAT(result.notes[1], Catch::Matchers::Contains("scaled to the clip's variance"));
  CHECK_THAT(result.notes[0],
             Catch::Matchers::Contains("not stable") && Catch::Matchers::Contains("Yule-Walker"));
  const dytex::LinearDynamicTexture& texture = result.texture;
  CHECK(dytex::spectral_radius(texture.A) < 1);
  const Eigen::MatrixXd data = texture.states * texture.states.transpose() / 40;
  const Eigen::MatrixXd drawn = dytex::stationary_covariance(texture.A, texture.B);
  CHECK((drawn / drawn.trace() - data / data.trace()).norm() < 1e-9);
  CHECK(dytex::detail::variance_within(texture.A, texture.B, 40).sum() == Approx(data.trace()));
}

TEST_CASE("The variance within a clip is that about its own mean", "[dytex][learn]") {
  Eigen::MatrixXd A(2, 2), B(2, 1);
  A << 0.9, 0.2, -0.1, 0.7;
  B << 1, 0.5;
  const Eigen::MatrixXd P = dytex::stationary_covariance(A, B);
  for (const Eigen::Index frames : {1, 2, 3, 7, 40, 101}) {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(2, 2);  // of the covariances of all pairs of frames
    for (Eigen::Index i = 0; i < frames; ++i)
      for (Eigen::Index j = 0; j < frames; ++j) {
        Eigen::MatrixXd between = P;
        for (Eigen::Index k = 0; k < std::abs(i - j); ++k) between = A * between;
        sum += i >= j ? between : Eigen::MatrixXd(between.transpose());
      }
    const Eigen::VectorXd expected = P.diagonal() - sum.diagonal() / double(frames * frames);
    CHECK((dytex::detail::variance_within(A, B, frames) - expected).norm() < 1e-12 * P.norm());
  }
}

TEST_CASE("A model that varies much more or less than its clip is scaled to it", "[dytex][learn]") {
  // One slow swing: the fit is stable, its variance in the long run another.
  Eigen::MatrixXd levels(12, 30);
  const Eigen::MatrixXd shapes = test::orthonormal(12, 2, 3), grain = test::normals(12, 30, 4);
  for (int t = 0; t < 30; ++t)
    levels.col(t) = (60 * std::exp(-0.15 * t) * shapes.col(0) + 0.05 * grain.col(t)).array() + 100;
  const dytex::LearnResult result = learn(test::clip_of(levels, 4, 3, 1, CV_32F), 1);
  const dytex::LinearDynamicTexture& texture = result.texture;
  REQUIRE(result.transition == dytex::Transition::least_squares);
  REQUIRE(result.notes.size() == 1);
  CHECK_THAT(result.notes[0], Catch::Matchers::Contains("times the variance") &&
                                  Catch::Matchers::Contains("scaled to the clip's variance"));
  CHECK(dytex::detail::variance_within(texture.A, texture.B, 30)[0] ==
        Approx(texture.states.squaredNorm() / 30).epsilon(1e-9));
}

TEST_CASE("Any states give a stable fit and Yule-Walker the data's variance", "[dytex][learn]") {
  int unstable = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Eigen::Index frames = 8 + static_cast<Eigen::Index>(seed % 20),
                       n = 1 + static_cast<Eigen::Index>(seed % 7);
    Eigen::MatrixXd walks = test::normals(frames, n, seed);
    for (Eigen::Index t = 1; t < frames; ++t) walks.row(t) += walks.row(t - 1);
    walks.rowwise() -= walks.colwise().mean().eval();
    const test::ThinSvd svd = test::thin_svd(walks);
    const auto fit = dytex::detail::fit_dynamics({svd.s, svd.U}, {});
    REQUIRE(dytex::spectral_radius(fit.A) < 1);
    const bool yule_walker = fit.transition == dytex::Transition::yule_walker;
    CHECK(yule_walker == (fit.least_squares_radius >= 1 || fit.noiseless));
    if (!yule_walker) continue;
    ++unstable;
    const Eigen::MatrixXd data = (svd.s.cwiseAbs2() / static_cast<double>(frames)).asDiagonal();
    CHECK((dytex::stationary_covariance(fit.A, fit.B) - data).norm() < 1e-8 * data.norm());
  }
  CHECK(unstable > 10);
}
