// SPDX-License-Identifier: Apache-2.0
#include "dytex/editing/edit.hpp"
#include "tests/dytex/distances/systems.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::dytex;
using Eigen::MatrixXd;
using test::apart;

namespace {

LinearDynamicTexture with_edits(const LinearDynamicTexture& texture, const std::vector<Edit>& edits) {
  return edit(texture, edits).texture;
}

/// An auto-regression of second order: the state holds two frames, the noise comes in by the first.
LinearDynamicTexture second_order() {
  MatrixXd A = MatrixXd::Zero(6, 6), B = MatrixXd::Zero(6, 3);
  A.topLeftCorner(3, 3) = 1.4 * test::orthonormal(3, 3, 2) * 0.8;
  A.topRightCorner(3, 3) = -0.6 * MatrixXd::Identity(3, 3);
  A.bottomLeftCorner(3, 3).setIdentity();
  B.topRows(3) = test::normals(3, 3, 4);
  return test::texture_of(A, B, 3);
}

std::vector<LinearDynamicTexture> models() {
  std::vector<LinearDynamicTexture> result{test::texture_with({{0.95, 0.3}, {0.9, 2}, {0.5}, {-0.7}}),
                                           second_order()};
  for (std::uint64_t seed = 0; seed < 5; ++seed)
    result.push_back(test::random_texture(7, seed == 0 ? 0.9999 : 0.9, seed, seed < 3 ? 7 : 3));
  return result;
}

}  // namespace

TEST_CASE("Backwards every covariance over time is the transpose of the forward one", "[dytex][reversal]") {
  for (const LinearDynamicTexture& texture : models()) {
    const LinearDynamicTexture back = with_edits(texture, {{Reverse{}}});
    CHECK(spectral_radius(back.A) < 1);
    for (int k = 0; k < 6; ++k)
      CHECK((test::lag_covariance(back, k) - test::lag_covariance(texture, k).transpose()).norm() <
            1e-8 * test::covariance(texture).norm());
    CHECK(apart(test::lag_covariance(back, 1), test::lag_covariance(texture, 1)) > 1e-3);
  }
}

TEST_CASE("Backwards twice is forwards", "[dytex][reversal]") {
  for (const LinearDynamicTexture& texture : models()) {
    const LinearDynamicTexture twice = with_edits(texture, {{Reverse{}}, {Reverse{}}});
    CHECK(apart(twice.A, texture.A) < 1e-7);
    CHECK((twice.B * twice.B.transpose() - texture.B * texture.B.transpose()).norm() <
          1e-8 * test::covariance(texture).norm());
  }
}

TEST_CASE("Speed of minus 1 keeps the spectrum only", "[dytex][reversal]") {
  const LinearDynamicTexture texture = test::texture_with({{0.95, 0.3}, {0.9, 2}, {0.8, 1.2}});
  const LinearDynamicTexture back = with_edits(texture, {{Speed{-1}}});
  MatrixXd forward = texture.A, backward = back.A;
  for (int k = 1; k <= 6; ++k) {  // as many power sums as poles
    CHECK(std::abs(forward.trace() - backward.trace()) < 1e-10);
    forward = (forward * texture.A).eval();
    backward = (backward * back.A).eval();
  }
  CHECK(apart(test::lag_covariance(back, 1), test::lag_covariance(texture, 1).transpose()) > 0.01);
}
