// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "core/error.hpp"
#include "dytex/distances/distances.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/linear_textures.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/reference_linalg.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

using dytex::LinearDynamicTexture;

/// An orthonormal basis of all courses of `frames` frames.
Eigen::MatrixXd courses(const LinearDynamicTexture& texture, Eigen::Index frames) {
  const Eigen::Index m = texture.pixels();
  Eigen::MatrixXd all(m * frames, texture.order()), part = test::whole_C(texture);
  for (Eigen::Index t = 0; t < frames; ++t) {
    all.middleRows(t * m, m) = part;
    part = (part * texture.A).eval();
  }
  return test::orthonormal_columns(all);
}

}  // namespace

TEST_CASE("Subspace angles are those of long courses", "[dytex][angles]") {
  for (const auto& [p, q] : {std::pair{made_texture(3, 2, 2, 1, 0.9), made_texture(3, 2, 2, 2, 0.9)},
                             {made_texture(3, 3, 4, 3, 0.9), made_texture(3, 3, 2, 4, 0.5)},
                             {made_texture(3, 2, 2, 5, 0.8, 4), made_texture(3, 2, 3, 6, 0.8)}}) {
    const Eigen::Index frames = 250;
    const Eigen::VectorXd cosines =
        test::singular_values(courses(p, frames).transpose() * courses(q, frames));
    const Eigen::VectorXd angles = dytex::subspace_angles(p, q);
    REQUIRE(angles.size() == cosines.size());
    for (Eigen::Index i = 0; i < angles.size(); ++i)
      CHECK_THAT(std::cos(angles[i]), WithinAbs(cosines[i], 1e-9));
    CHECK(angles.minCoeff() >= 0);
    CHECK(angles.maxCoeff() <= std::acos(0.0));
    CHECK_THAT(dytex::grassmann_distance(angles), WithinRel(angles.norm(), 1e-15));
  }
}

TEST_CASE("A component that is not shown has no angle", "[dytex][angles]") {
  LinearDynamicTexture p = made_texture(3, 2, 2, 1), q = made_texture(3, 2, 2, 2);
  p.A.setZero();
  p.A.diagonal() << 0.5, 0.25;
  p.weights << 2, 0;
  const Eigen::VectorXd angles = dytex::subspace_angles(p, q);
  CHECK(angles.size() == 1);
  q = p;
  q.C.col(1).setZero();
  CHECK(dytex::subspace_angles(p, q)[0] == 0);
}

TEST_CASE("The angle between two orders of one course is small but there", "[dytex][angles]") {
  const LinearDynamicTexture p = made_texture(6, 5, 3, 1, 0.9);
  LinearDynamicTexture q = p;
  q.A(0, 0) += 1e-4;
  const Eigen::VectorXd angles = dytex::subspace_angles(p, q);
  CHECK(angles[2] > 1e-6);
  CHECK(angles[2] < 1e-2);
  q.A(0, 0) = p.A(0, 0) + 1e-3;
  CHECK_THAT(dytex::subspace_angles(p, q)[2] / angles[2], WithinRel(10.0, 0.05));
}

TEST_CASE("All distances of many models agree with those of each pair", "[dytex][angles]") {
  std::vector<LinearDynamicTexture> models;
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
    models.push_back(made_texture(4, 3, static_cast<Eigen::Index>(seed), seed));
  const auto all = dytex::all_distances(models);
  REQUIRE(all.size() == 10);
  for (const auto measure : dytex::kMeasures) {
    if (measure == dytex::Measure::windows) continue;  // frames are too small for any
    const Eigen::MatrixXd matrix = dytex::distance_matrix(all, measure);
    REQUIRE(matrix.rows() == 4);
    CAPTURE(dytex::name(measure));
    for (Eigen::Index i = 0; i < 4; ++i) {
      CHECK_THAT(matrix(i, i), WithinAbs(0, 0));
      for (Eigen::Index j = 0; j < 4; ++j) {
        const auto& p = models[static_cast<std::size_t>(i)];
        const auto& q = models[static_cast<std::size_t>(j)];
        if (i != j) CHECK(matrix(i, j) > 0.1);
        if (measure == dytex::Measure::kl)
          CHECK_THAT(matrix(i, j), WithinRel(dytex::kl_rate(p, q), 1e-10));
        else
          CHECK_THAT(matrix(i, j), WithinAbs(distance(dytex::distances(p, q), measure), 1e-7));
      }
    }
  }
}

TEST_CASE("A model that lacks a distance leaves the others theirs", "[dytex][angles]") {
  std::vector<LinearDynamicTexture> models{made_texture(4, 3, 2, 1), made_texture(4, 3, 2, 2),
                                           made_texture(4, 3, 3, 3), made_texture(4, 3, 0, 4)};
  models[1].r = 0;
  CHECK_FALSE(dytex::has_noise(models[1]));
  CHECK(dytex::has_noise(models[0]));
  const auto all = dytex::all_distances(models);
  for (const auto measure : dytex::kMeasures) {
    if (measure == dytex::Measure::windows) continue;  // frames are too small for any
    CAPTURE(dytex::name(measure));
    const Eigen::MatrixXd matrix = dytex::distance_matrix(all, measure);
    const Eigen::Index lacking = measure == dytex::Measure::kl ? 1 : 3;
    for (Eigen::Index i = 0; i < 4; ++i)
      for (Eigen::Index j = 0; j < 4; ++j) {
        CHECK(std::isnan(matrix(i, j)) == (i == lacking || j == lacking));
        if (measure == dytex::Measure::kl && i != lacking && j != lacking)
          CHECK_THAT(matrix(i, j), WithinRel(dytex::kl_rate(models[static_cast<std::size_t>(i)],
                                                            models[static_cast<std::size_t>(j)]),
                                             1e-10));
      }
  }
}

TEST_CASE("Angles and matrices that cannot be are refused", "[dytex][angles]") {
  const LinearDynamicTexture p = made_texture(3, 2, 2, 1), still = made_texture(3, 2, 0, 2);
  CHECK(test::message_of<core::InputError>([&] { dytex::subspace_angles(p, still); }) ==
        "the second model has no components, so no angles");
  CHECK(test::message_of<core::InputError>([&] { dytex::subspace_angles(still, p); }) ==
        "the first model has no components, so no angles");
  const auto pair = dytex::distances(p, still);
  CHECK(pair.angles.size() == 0);
  CHECK(pair.kl.has_value());
  CHECK(test::message_of<core::InputError>([&] { distance(pair, dytex::Measure::martin); }) ==
        "a model has no components, so there are no angles");
  LinearDynamicTexture exact = p;
  exact.r = 0;
  CHECK(test::message_of<core::InputError>([&] {
          distance(dytex::distances(p, exact), dytex::Measure::kl);
        }).starts_with("a model's noise r is 0"));
  const std::vector<LinearDynamicTexture> models{p, p, made_texture(3, 3, 2, 1)};
  CHECK(test::message_of<core::InputError>([&] {
          dytex::all_distances(models);
        }).starts_with("model 2: frames of 3×2 in grey and of 3×3 in grey"));
  const std::vector<dytex::Distances> two(2);
  CHECK(test::message_of<core::InputError>([&] { dytex::distance_matrix(two, dytex::Measure::kl); }) ==
        "distance_matrix: 2 pairs are not all pairs of any number of models");
}
