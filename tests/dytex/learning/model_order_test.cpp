// SPDX-License-Identifier: Apache-2.0
// Number of components, compared with known ranks and with errors measured on pixels.
#include "dytex/learning/model_order.hpp"

#include "core/error.hpp"
#include "dytex/learn.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/matrices.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/reference_linalg.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

/// Six modes that turn and fade, driven by noise, under pixel noise of variance 4.
core::Clip six_modes(int frames, std::uint64_t seed) {
  constexpr Eigen::Index m = 30 * 20, n = 6;
  const Eigen::MatrixXd C = test::orthonormal(m, n, seed), drive = test::normals(n, frames, seed + 1);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < 3; ++i) {
    const double angle = 0.3 + 0.4 * i;
    A.block<2, 2>(2 * i, 2 * i) << 0.95 * std::cos(angle), -0.95 * std::sin(angle), 0.95 * std::sin(angle),
        0.95 * std::cos(angle);
  }
  Eigen::MatrixXd states(n, frames);
  states.col(0).setZero();
  for (int t = 1; t < frames; ++t) states.col(t) = A * states.col(t - 1) + 60 * drive.col(t);
  return test::clip_of((C * states + 2 * test::normals(m, frames, seed + 2)).array() + 128, 30, 20, 1,
                       CV_32F);
}

dytex::LearnResult learned(const core::Clip& clip, dytex::Order order) {
  core::ClipSource source(clip);
  dytex::LearnOptions options;
  options.order = order;
  return dytex::learn(source, options);
}

}  // namespace

TEST_CASE("Singular values above noise are counted", "[dytex][order]") {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const core::Clip clip = six_modes(120, 10 * seed);
    CHECK(learned(clip, dytex::Order::gavish_donoho).texture.components() == 6);
  }
  // Nothing but noise: the threshold for a square matrix is 4/√3 in units of √m σ, here near 2.86 medians.
  const Eigen::VectorXd noise = test::singular_values(test::normals(80, 80, 1));
  Eigen::VectorXd singular = Eigen::VectorXd::Zero(81);
  singular.head(80) = noise;
  CHECK(dytex::detail::gavish_donoho(singular, 80) == 0);
  singular[0] = 1.1 * 4 / std::sqrt(3.0) * std::sqrt(80.0);
  CHECK(dytex::detail::gavish_donoho(singular, 80) == 1);
  singular[0] = 0.9 * 4 / std::sqrt(3.0) * std::sqrt(80.0);
  CHECK(dytex::detail::gavish_donoho(singular, 80) == 0);
}

TEST_CASE("Held-out errors are those measured on pixels", "[dytex][order]") {
  const core::Clip clip = six_modes(50, 5);
  const Eigen::MatrixXd Y = test::levels_of(clip);
  const auto errors = dytex::detail::held_out_errors(Y.transpose() * Y, 1, Y.rows());
  const Eigen::MatrixXd trained = Y.leftCols(40);
  const Eigen::MatrixXd centred = Y.colwise() - trained.rowwise().mean();
  const Eigen::MatrixXd U = test::thin_svd(centred.leftCols(40)).U;
  REQUIRE(errors.size() == 38);
  for (const int n : {1, 4, 6, 20, 38}) {
    const Eigen::MatrixXd C = U.leftCols(n), states = C.transpose() * centred;
    const Eigen::MatrixXd before = states.leftCols(39), after = states.middleCols(1, 39);
    const Eigen::MatrixXd A = after * before.transpose() * test::inverse(before * before.transpose());
    const Eigen::MatrixXd off = centred.rightCols(10) - C * (A * states.middleCols(39, 10));
    const auto& [order, error] = errors[static_cast<std::size_t>(n) - 1];
    CHECK(order == n);
    CHECK_THAT(error, WithinRel(off.squaredNorm() / static_cast<double>(off.size()), n > 30 ? 1e-4 : 1e-7));
  }
}

TEST_CASE("What predicts best is near the true order", "[dytex][order]") {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const dytex::LearnResult result = learned(six_modes(200, 20 * seed), dytex::Order::held_out);
    CHECK(result.texture.components() >= 6);
    CHECK(result.texture.components() <= 8);
    REQUIRE(result.held_out.size() > 60);
    for (const auto& [n, error] : result.held_out) CHECK(error > 3.5);  // pixel noise is not predictable
  }
  CHECK(test::message_of<core::InputError>([&] { learned(six_modes(9, 1), dytex::Order::held_out); }) ==
        "order: to hold out a fifth of the frames takes a clip of at least 10, this has 9");
}
