// SPDX-License-Identifier: Apache-2.0
// The filter and the smoother against one dense Gaussian of all frames.
#include "dytex/estimation/kalman.hpp"

#include <algorithm>
#include <limits>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "dytex/estimation/observations.hpp"
#include "dytex/linear_dynamic_texture.hpp"
#include "tests/dytex/estimation/dense_gaussian.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/matrices.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/reference_linalg.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

struct Case {
  dytex::StateSpace space;
  test::Look look;
  Eigen::MatrixXd Y, seen;
};

Eigen::MatrixXd stable(Eigen::Index n, double radius, std::uint64_t seed) {
  const Eigen::MatrixXd A = test::normals(n, n, seed);
  return A * (radius / test::eigenvalues(A).cwiseAbs().maxCoeff());
}

/// A random case of m values, n states, k noises; a share of values is hidden.
Case random_case(Eigen::Index m, Eigen::Index n, Eigen::Index k, Eigen::Index frames, double hidden,
                 std::uint64_t seed) {
  Case made;
  made.space = {stable(n, 0.95, seed), 2 * test::normals(n, k, seed + 1), test::normals(n, 1, seed + 2),
                3 * test::normals(n, n, seed + 3)};
  made.look = {test::normals(m, n, seed + 4), 5 * test::normals(m, 1, seed + 5),
               (test::normals(m, 1, seed + 6).array().square() + 0.3).matrix()};
  made.Y = 4 * test::normals(m, frames, seed + 7);
  made.seen = Eigen::MatrixXd::Ones(m, frames);
  core::Rng rng(seed + 8);
  for (double& one : made.seen.reshaped())
    if (rng.uniform() < hidden) one = 0;
  return made;
}

void check_against_dense(const Case& made) {
  const auto dense = test::dense_gaussian(made.space, made.look, made.Y, made.seen);
  const auto seen = test::plain_observations(made.look, made.Y, made.seen);
  const dytex::Filtered filtered = dytex::filter(made.space, seen);
  CHECK_THAT(filtered.log_likelihood, WithinRel(dense.log_likelihood, 1e-9));
  const dytex::Smoothed smoothed = dytex::smooth(made.space, filtered);
  CHECK((smoothed.states - dense.states).norm() <= 1e-9 * dense.states.norm());
  const double size = dense.covariance.norm();
  for (Eigen::Index t = 0; t < made.Y.cols(); ++t) {
    CHECK((smoothed.at(t).covariance - dense.block(t, t)).norm() <= 1e-9 * size);
    if (t + 1 < made.Y.cols())
      CHECK((smoothed.at(t).with_next - dense.block(t + 1, t)).norm() <= 1e-9 * size);
  }
  // The filter is the smoother of a clip that ends here.
  const Eigen::Index middle = made.Y.cols() / 2;
  const auto part = test::dense_gaussian(made.space, made.look, made.Y.leftCols(middle + 1),
                                         made.seen.leftCols(middle + 1));
  CHECK((filtered.states.col(middle) - part.states.col(middle)).norm() <=
        1e-9 * part.states.col(middle).norm());
}

}  // namespace

TEST_CASE("The filter and the smoother equal a dense Gaussian", "[dytex][kalman]") {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    INFO("seed " << seed);
    check_against_dense(random_case(7, 3, 3, 9, 0, 100 * seed));
    check_against_dense(random_case(2, 4, 4, 8, 0, 100 * seed + 50));  // fewer values than states
  }
}

TEST_CASE("The filter and the smoother are exact where values and frames are hidden", "[dytex][kalman]") {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    INFO("seed " << seed);
    Case made = random_case(6, 3, 3, 10, 0.4, 1000 + 100 * seed);
    made.seen.col(static_cast<Eigen::Index>(seed)).setZero();
    made.seen.middleCols(6, 2).setZero();
    check_against_dense(made);
  }
}

TEST_CASE("Singular noise and a known first state and one frame are no trouble", "[dytex][kalman]") {
  Case made = random_case(5, 3, 1, 9, 0.2, 7);
  check_against_dense(made);
  made.space.A.setZero();  // predicted covariances of rank one
  check_against_dense(made);
  made = random_case(5, 3, 1, 9, 0.2, 8);
  made.space.first_factor.setZero();
  check_against_dense(made);
  made.space.B.resize(3, 0);  // nothing is unknown
  const auto dense = test::dense_gaussian(made.space, made.look, made.Y, made.seen);
  const auto filtered = dytex::filter(made.space, test::plain_observations(made.look, made.Y, made.seen));
  CHECK_THAT(filtered.log_likelihood, WithinRel(dense.log_likelihood, 1e-9));
  CHECK(dytex::smooth(made.space, filtered).states.allFinite());
  check_against_dense(random_case(5, 3, 3, 1, 0, 9));
}

TEST_CASE("Kept covariances change nothing", "[dytex][kalman]") {
  // Long enough to become steady, then a gap, then steady again.
  Case made = random_case(8, 2, 2, 150, 0, 20);
  made.seen.middleCols(80, 3).setZero();
  const auto seen = test::plain_observations(made.look, made.Y, made.seen);
  const auto filtered = dytex::filter(made.space, seen);
  CHECK(filtered.steps.size() < 110);
  CHECK(dytex::smooth(made.space, filtered).steps.size() < 130);
  check_against_dense(made);
}

TEST_CASE("What is seen of a clip follows the definition", "[dytex][kalman]") {
  const Eigen::Index m = 3 * 20 * 17, n = 4, frames = 11;
  dytex::LinearDynamicTexture texture;
  texture.info = {20, 17, 3, CV_32F, 25, 1, frames};
  texture.mean = (test::normals(m, 1, 1).array() * 5 + 120).matrix().cast<float>();
  texture.C = test::orthonormal(m, n, 2).cast<float>();
  texture.weights = Eigen::Vector4d(1, 0.5, 2, 1);
  texture.A = 0.9 * Eigen::MatrixXd::Identity(6, 6);  // two numbers that do not show
  texture.B = test::normals(6, 3, 3);
  texture.states = Eigen::MatrixXd::Zero(6, frames);
  texture.singular = Eigen::VectorXd::Zero(frames);
  texture.r = 2;
  const core::Clip clip =
      test::clip_of((30 * test::normals(m, frames, 4).array() + 120).matrix(), 20, 17, 3, CV_32F);
  core::Clip mask{{20, 17, 1, CV_8U, 25, 255, frames}, {}};
  Eigen::MatrixXd seen = Eigen::MatrixXd::Ones(m, frames);
  core::Rng rng(5);
  for (Eigen::Index t = 0; t < frames; ++t) {
    mask.frames.emplace_back(17, 20, CV_8U, cv::Scalar(0));
    // whole, a fifth hidden, most hidden, gone
    const double share = t % 4 == 0 ? 0 : t % 4 == 1 ? 0.2 : t % 4 == 2 ? 0.8 : 2;
    for (Eigen::Index p = 0; p < 20 * 17; ++p) {
      if (rng.uniform() >= share) continue;
      mask.frames.back().data[p] = 200;
      seen.col(t).segment(3 * p, 3).setZero();
    }
  }
  core::ClipSource mask_source(mask);
  const dytex::Missing missing(mask_source, clip.info);
  for (const bool per_value : {false, true}) {
    if (per_value) texture.noise = (test::normals(m, 1, 6).array().square() + 0.2).matrix().cast<float>();
    const Eigen::VectorXd noise =
        per_value ? texture.noise.cast<double>().eval() : Eigen::VectorXd::Constant(m, 2);
    const test::Look look{texture.C.cast<double>() * texture.weights.asDiagonal(),
                          texture.mean.cast<double>(), noise};
    const auto plain = test::plain_observations(look, test::levels_of(clip), seen);
    core::ClipSource source(clip);
    const auto found = dytex::observe(texture, source, missing);
    REQUIRE(found.frames() == frames);
    CHECK((found.vectors.topRows(n) - plain.vectors).norm() < 1e-9 * plain.vectors.norm());
    CHECK(found.vectors.bottomRows(2).isZero(0));
    CHECK((found.squares - plain.squares).norm() < 1e-10 * plain.squares.norm());
    CHECK((found.constants - plain.constants).norm() < 1e-10 * plain.constants.norm());
    for (std::size_t t = 0; t < static_cast<std::size_t>(frames); ++t) {
      INFO("frame " << t);
      REQUIRE((found.which[t] < 0) == (plain.which[t] < 0));
      if (found.which[t] < 0) continue;
      const Eigen::MatrixXd& K = found.information[static_cast<std::size_t>(found.which[t])];
      const Eigen::MatrixXd& truth = plain.information[static_cast<std::size_t>(plain.which[t])];
      CHECK((K.topLeftCorner(n, n) - truth).norm() < 1e-9 * truth.norm());
      CHECK(K.bottomRows(2).isZero(0));
    }
    for (const std::size_t threads : {1, 8}) {
      const core::ThreadLimit limit(threads);
      const auto again = dytex::observe(texture, source, missing);
      CHECK(again.vectors == found.vectors);
      CHECK(again.squares == found.squares);
      CHECK(again.information == found.information);
    }
  }
}

TEST_CASE("A long clip at fifty states keeps its covariances sane", "[dytex][kalman]") {
  const Eigen::Index n = 50, frames = 400;
  dytex::StateSpace space{stable(n, 0.999, 1), test::normals(n, 10, 2), Eigen::VectorXd::Zero(n),
                          1e4 * Eigen::MatrixXd::Identity(n, n)};
  dytex::Observations seen;
  seen.vectors = 1e3 * test::normals(n, frames, 3);
  seen.squares = Eigen::VectorXd::Constant(frames, 1e9);
  seen.constants = Eigen::VectorXd::Zero(frames);
  seen.information = {Eigen::MatrixXd::Identity(n, n) * 10};
  seen.which.assign(frames, 0);
  const auto smoothed = dytex::smooth(space, dytex::filter(space, seen));
  CHECK(smoothed.states.allFinite());
  for (const auto& step : smoothed.steps) {
    const Eigen::MatrixXd& P = step.covariance;
    REQUIRE(P == P.transpose());
    const Eigen::VectorXd values = test::symmetric_eigenvalues(P);
    REQUIRE(values.minCoeff() > -1e-12 * values.maxCoeff());
  }
}

TEST_CASE("What the filter cannot take is named", "[dytex][kalman]") {
  Case made = random_case(4, 2, 2, 5, 0, 1);
  const auto seen = test::plain_observations(made.look, made.Y, made.seen);
  const auto said = [&](const dytex::StateSpace& space, const dytex::Observations& what) {
    return test::message_of<core::InputError>([&] { dytex::filter(space, what); });
  };
  auto space = made.space;
  space.A(0, 0) = std::numeric_limits<double>::quiet_NaN();
  CHECK(said(space, seen) == "filter: A has a value that is not finite");
  space = made.space;
  space.first.resize(3);
  CHECK(said(space, seen) == "filter: first is 3 × 1, must be 2 × 1");
  auto bad = seen;
  bad.which[2] = 7;
  CHECK(said(made.space, bad) == "filter: which is 7; allowed is -1 to 0");
  bad = seen;
  bad.squares[1] = std::numeric_limits<double>::infinity();
  CHECK(said(made.space, bad) == "filter: squares has a value that is not finite");
}
