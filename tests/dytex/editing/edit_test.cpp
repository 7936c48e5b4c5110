// SPDX-License-Identifier: Apache-2.0
#include "dytex/editing/edit.hpp"

#include <algorithm>
#include <map>
#include <numbers>
#include <string_view>

#include "core/error.hpp"
#include "dytex/model/archive.hpp"
#include "tests/dytex/distances/systems.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/reference_linalg.hpp"

using namespace emberfold;
using namespace emberfold::dytex;
using namespace emberfold::test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

EditResult edited(const LinearDynamicTexture& texture, const std::vector<Edit>& edits) {
  return edit(texture, edits);
}

LinearDynamicTexture after(const LinearDynamicTexture& texture, const std::vector<Edit>& edits) {
  return edit(texture, edits).texture;
}

const std::vector<Pole> kPoles{{0.95, 0.3}, {0.9, 0.8}, {0.7, 1.7}, {0.85}, {-0.6}};

/// A' of Speed, from the poles by which the model was made.
MatrixXd expected_speed(const std::vector<Pole>& poles, double factor) {
  std::vector<Pole> changed = poles;
  Eigen::Index n = 0;
  for (Pole& pole : changed) {
    n += pole.phase < 0 ? 1 : 2;
    if (pole.phase < 0) continue;
    if (std::abs(factor) * pole.phase > std::numbers::pi) pole.modulus = 0;
    // A negative phase would read as a real pole.
    pole.phase = std::fmod(factor * pole.phase + 4 * std::numbers::pi, 2 * std::numbers::pi);
  }
  const MatrixXd S = test::basis(n, 1);
  return S * test::diagonal_of(changed) * test::inverse(S);
}

double shown_variance(const LinearDynamicTexture& texture) {
  return texture.weights.cwiseAbs2().dot(test::covariance(texture).diagonal().head(texture.components()));
}

std::vector<Edit> one_of_each() {
  return {{Speed{1.7}},     {Speed{-0.4}},          {Flow{0.5}},       {Flow{2.5}},           {Reverse{}},
          {Intensity{0.3}}, {Directions{{2, 0.5}}}, {Scales{2, 1, 0}}, {Weights{{0.5, 1.5}}}, {Speed{0}}};
}

}  // namespace

TEST_CASE("Edits of factor 1 change no bit", "[dytex][edit]") {
  for (const LinearDynamicTexture& texture :
       {test::texture_with(kPoles), test::random_texture(5, 0.9, 3), test::random_texture(9, 0.9, 7, 4),
        test::random_texture(4, 0, 5)}) {
    for (const Edit& one : std::vector<Edit>{
             {Speed{}}, {Flow{}}, {Intensity{}}, {Directions{{1, 1}}}, {Scales{}}, {Weights{{1, 1, 1}}}}) {
      const EditResult result = edited(texture, {one});
      CHECK(test::same(result.texture, texture));
      CHECK(result.notes.empty());
      CHECK(result.dropped == 0);
    }
    CHECK(test::same(after(texture, {}), texture));
  }
}

TEST_CASE("Edits near factor 1 change next to nothing", "[dytex][edit]") {
  constexpr double kNear = 1 + 1e-9;
  const LinearDynamicTexture texture = test::texture_with(kPoles);
  for (const Edit& one :
       std::vector<Edit>{{Speed{kNear}}, {Flow{kNear}}, {Intensity{kNear}}, {Directions{{kNear}}}}) {
    const LinearDynamicTexture found = after(texture, {one});
    CHECK(apart(found.A, texture.A) < 1e-7);
    CHECK(apart(found.B, texture.B) < 1e-6);
  }
}

TEST_CASE("Speed scales the phases of pairs and keeps moduli and real poles", "[dytex][edit]") {
  const LinearDynamicTexture texture = test::texture_with(kPoles);
  for (const double factor : {-3.0, -1.0, -0.5, 0.0, 0.4, 1.5, 1.9, 3.0}) {
    const EditResult result = edited(texture, {{Speed{factor}}});
    CHECK(apart(result.texture.A, expected_speed(kPoles, factor)) < 1e-10);
    CHECK(result.dropped == (std::abs(factor) > 1.85 ? 2 : 0));
    CHECK(result.notes.size() == (std::abs(factor) > 1.85 ? 1 : 0));
    CHECK((result.texture.C.array() == texture.C.array()).all());
  }
}

TEST_CASE("Speed and back gives the model back where no pole was dropped", "[dytex][edit]") {
  const LinearDynamicTexture texture = test::texture_with(kPoles);
  for (const double factor : {-1.8, -1.0, 0.4, 1.8}) {
    const LinearDynamicTexture found = after(texture, {{Speed{factor}}, {Speed{1 / factor}}});
    CHECK(apart(found.A, texture.A) < 1e-11);
    CHECK(apart(found.B, texture.B) < 1e-11);
  }
  CHECK(apart(after(texture, {{Speed{3}}, {Speed{1 / 3.0}}}).A, texture.A) > 0.01);
}

TEST_CASE("Speed keeps the contrast of what is shown unless told otherwise", "[dytex][edit]") {
  LinearDynamicTexture texture = test::random_texture(8, 0.97, 4);
  texture.weights = VectorXd::LinSpaced(8, 2, 0.1);
  for (const double factor : {-1.0, 0.3, 2.0}) {
    const LinearDynamicTexture kept = after(texture, {{Speed{factor}}});
    CHECK_THAT(shown_variance(kept), WithinRel(shown_variance(texture), 1e-10));
    CHECK(apart(kept.B / kept.B.norm(), texture.B / texture.B.norm()) < 1e-12);
    const LinearDynamicTexture left = after(texture, {{Speed{factor}, false}});
    CHECK(left.B == texture.B);
    CHECK(left.A == kept.A);
    CHECK(std::abs(shown_variance(left) / shown_variance(texture) - 1) > 1e-3);
  }
  texture.weights.setZero();  // nothing is shown: all of P counts
  CHECK_THAT(test::covariance(after(texture, {{Speed{2}}})).trace(),
             WithinRel(test::covariance(texture).trace(), 1e-10));
}

TEST_CASE("Intensity multiplies the stationary covariance by itself", "[dytex][edit]") {
  const LinearDynamicTexture texture = test::random_texture(7, 0.95, 6, 4);
  const MatrixXd P = test::covariance(texture);
  for (const double factor : {0.25, 2.0, 3.0}) {
    const LinearDynamicTexture found = after(texture, {{Intensity{factor}}});
    CHECK(apart(test::covariance(found), factor * P) < 1e-13);
    CHECK(found.A == texture.A);
    // The rescaling of what comes later leaves it alone.
    CHECK_THAT(shown_variance(after(found, {{Speed{0.5}}, {Flow{1.3}}})),
               WithinRel(factor * P.trace(), 1e-9));
  }
  CHECK(test::covariance(after(texture, {{Intensity{0}}})).norm() == 0);
  // A texture without noise goes on being editable.
  CHECK(after(texture, {{Intensity{0}}, {Speed{2}}, {Flow{0.5}}, {Reverse{}}}).B.norm() == 0);
}

TEST_CASE("At flow 0 time stands still and the contrast stays", "[dytex][edit]") {
  for (const LinearDynamicTexture& texture :
       {test::texture_with(kPoles), test::random_texture(9, 0.9, 7, 4), test::random_texture(4, 0, 5)})
    for (const bool contrast : {true, false}) {
      const LinearDynamicTexture found = after(texture, {{Flow{0}, contrast}});
      const MatrixXd P = test::covariance(texture);
      const MatrixXd stationary = stationary_covariance(found.A, found.B);
      CHECK(apart(stationary.diagonal(), P.diagonal()) < 1e-3);
      // E |x(t + 1) − x(t)|²
      const MatrixXd I = MatrixXd::Identity(found.A.rows(), found.A.cols());
      const double moved =
          ((found.A - I) * P * (found.A - I).transpose() + found.B * found.B.transpose()).trace();
      CHECK(moved < 1e-11 * P.trace());
      CHECK(spectral_radius(found.A) < 1);
    }
}

TEST_CASE("Directions multiply the eigenvalues of Q", "[dytex][edit]") {
  const MatrixXd U = test::orthonormal(4, 4, 3);
  const Eigen::Vector4d deviations(5, 3, 2, 1), factors(0.5, 1, 3, 0);
  const LinearDynamicTexture texture = test::texture_of(
      0.5 * MatrixXd::Identity(4, 4), U * deviations.asDiagonal() * test::orthonormal(4, 4, 9));
  const LinearDynamicTexture found = after(texture, {{Directions{{0.5, 1, 3, 0}}}});
  const MatrixXd expected = U * (deviations.cwiseAbs2().cwiseProduct(factors)).asDiagonal() * U.transpose();
  CHECK(apart(found.B * found.B.transpose(), expected) < 1e-13);
  const LinearDynamicTexture all = after(texture, {{Directions{{2, 2, 2, 2}}}});
  CHECK(apart(all.B, after(texture, {{Intensity{2}}}).B) < 1e-13);
}

TEST_CASE("Flow by a whole factor shows every such frame", "[dytex][edit]") {
  const std::vector<Pole> poles{{0.95, 0.3}, {0.9, 0.8}, {0.8, 2.4}, {0.85}, {0.2}};
  const LinearDynamicTexture texture = test::texture_with(poles);
  const MatrixXd Q = texture.B * texture.B.transpose();
  const EditResult twice = edited(texture, {{Flow{2}}});
  CHECK(apart(twice.texture.A, texture.A * texture.A) < 1e-11);
  CHECK(apart(twice.texture.B * twice.texture.B.transpose(), Q + texture.A * Q * texture.A.transpose()) <
        1e-10);
  CHECK(apart(test::covariance(twice.texture), test::covariance(texture)) < 1e-10);
  REQUIRE(twice.notes.size() == 1);
  CHECK(twice.notes[0].starts_with("2 of the poles turn by more than half a circle"));
  CHECK(apart(test::lag_covariance(twice.texture, 3), test::lag_covariance(texture, 6)) < 1e-9);
}

TEST_CASE("Flow scales lifetimes with phases and keeps the sign of real poles", "[dytex][edit]") {
  for (const double factor : {0.25, 0.5, 1.5, 3.0}) {
    std::vector<Pole> changed = kPoles;
    for (Pole& pole : changed) {
      pole.modulus = std::copysign(std::pow(std::abs(pole.modulus), factor), pole.modulus);
      if (pole.phase >= 0) pole.phase = std::fmod(pole.phase * factor, 2 * std::numbers::pi);
    }
    const MatrixXd S = test::basis(8, 1);
    const LinearDynamicTexture texture = test::texture_with(kPoles);
    CHECK(apart(after(texture, {{Flow{factor}}}).A, S * test::diagonal_of(changed) * test::inverse(S)) <
          1e-10);
  }
}

TEST_CASE("Flow and back gives the process back where a finer one is there", "[dytex][edit]") {
  // Twice as fast as a finer process, the half of which is therefore one.
  const LinearDynamicTexture fine = test::texture_with({{0.95, 0.3}, {0.9, 0.8}, {0.8, 1.4}, {0.85}, {0.2}});
  const LinearDynamicTexture texture = after(fine, {{Flow{2}}});
  const EditResult half = edited(texture, {{Flow{0.5}}});
  CHECK(half.notes.empty());
  CHECK(apart(half.texture.A, fine.A) < 1e-9);
  CHECK(apart(half.texture.B * half.texture.B.transpose(), fine.B * fine.B.transpose()) < 1e-8);
  const LinearDynamicTexture back = after(texture, {{Flow{3}}, {Flow{0.5}}, {Flow{2}}, {Flow{1 / 3.0}}});
  CHECK(apart(test::covariance(after(texture, {{Flow{3}}})), test::covariance(texture)) < 1e-9);
  CHECK(spectral_radius(back.A) < 1);
}

TEST_CASE("Flow keeps the contrast where no finer process is there and says so", "[dytex][edit]") {
  int cut = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const LinearDynamicTexture texture = test::random_texture(6, 0.97, seed);
    const EditResult half = edited(texture, {{Flow{0.5}}});
    CHECK_THAT(shown_variance(half.texture), WithinRel(shown_variance(texture), 1e-9));
    CHECK(apart(after(half.texture, {{Flow{2}}}).A, texture.A) < 1e-8);  // negative poles keep their sign
    cut += std::ranges::any_of(half.notes, [](const auto& note) { return note.starts_with("no noise"); }) ? 1
                                                                                                          : 0;
    const LinearDynamicTexture free = after(texture, {{Flow{0.5}, false}});
    CHECK(free.B == texture.B);
    CHECK(free.A == half.texture.A);
  }
  CHECK(cut > 0);
}

TEST_CASE("Nearly defective dynamics are turned as a whole", "[dytex][edit]") {
  const Eigen::Matrix2d one = test::pair_block(0.9, 0.7);
  MatrixXd D = MatrixXd::Zero(4, 4);
  D << one, Eigen::Matrix2d::Identity(), Eigen::Matrix2d::Zero(), one;
  const MatrixXd S = test::basis(4, 5);
  const LinearDynamicTexture texture = test::texture_of(S * D * test::inverse(S), test::normals(4, 4, 2));
  for (const double factor : {-2.0, 0.0, 0.5, 2.0, 4.0 / 3}) {
    const EditResult result = edited(texture, {{Speed{factor}}});
    MatrixXd turn = MatrixXd::Zero(4, 4);
    turn.topLeftCorner(2, 2) = turn.bottomRightCorner(2, 2) = test::pair_block(1, (factor - 1) * 0.7);
    CHECK(apart(result.texture.A, S * D * turn * test::inverse(S)) < 1e-6);
    REQUIRE(result.notes.size() == 1);
    CHECK(result.notes[0].starts_with("4 of the poles lie too close together"));
    if (factor != 0) CHECK(apart(after(result.texture, {{Speed{1 / factor}}}).A, texture.A) < 1e-6);
  }
  CHECK(apart(after(texture, {{Flow{2}}}).A, texture.A * texture.A) < 1e-8);
  const MatrixXd root = after(texture, {{Flow{0.5}}}).A;
  CHECK(apart(root * root, texture.A) < 1e-7);
}

TEST_CASE("Real Jordan blocks stay as they are at any speed and have powers", "[dytex][edit]") {
  for (const double pole : {0.8, -0.8}) {
    MatrixXd D = pole * MatrixXd::Identity(3, 3);
    D(0, 1) = D(1, 2) = 0.5;
    const MatrixXd S = test::basis(3, 6);
    const LinearDynamicTexture texture = test::texture_of(S * D * test::inverse(S), test::normals(3, 3, 2));
    for (const double factor : {-1.0, 0.5, 2.0})
      CHECK(apart(after(texture, {{Speed{factor}}}).A, texture.A) < 1e-4);
    const MatrixXd square = after(texture, {{Flow{2}}}).A, root = after(texture, {{Flow{0.5}}}).A;
    CHECK(apart(square, (pole > 0 ? 1 : -1) * texture.A * texture.A) < 1e-8);
    CHECK(apart((pole > 0 ? 1 : -1) * root * root, texture.A) < 1e-8);
  }
}

TEST_CASE("Poles that are nearly equal do not blow the dynamics up", "[dytex][edit]") {
  for (const double gap : {1e-3, 1e-6, 1e-9, 1e-12, 0.0}) {
    MatrixXd D = MatrixXd::Zero(5, 5);
    D.block<2, 2>(0, 0) = test::pair_block(0.9, 0.7);
    D.block<2, 2>(2, 2) = test::pair_block(0.9 - gap, 0.7 + gap);
    D.block<2, 2>(0, 2) = Eigen::Matrix2d{{1, 0.5}, {-0.3, 1}};
    D(4, 4) = 0.5;
    const MatrixXd S = test::basis(5, 7);
    const LinearDynamicTexture texture = test::texture_of(S * D * test::inverse(S), test::normals(5, 5, 2));
    for (const double factor : {-1.0, 0.5, 2.0}) {
      const LinearDynamicTexture found = after(texture, {{Speed{factor}}});
      CHECK(found.A.norm() < 10 * texture.A.norm());
      CHECK_THAT(spectral_radius(found.A), WithinAbs(0.9, 2e-4));
      CHECK(apart(after(found, {{Speed{1 / factor}}}).A, texture.A) < 1e-6);
    }
    CHECK(after(texture, {{Flow{0.5}}}).A.norm() < 10 * texture.A.norm());
  }
}

TEST_CASE("Every edited model is stable and can be kept in an archive", "[dytex][edit]") {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    for (const double radius : {0.3, 0.95, 0.999999}) {
      LinearDynamicTexture texture = test::random_texture(9, radius, seed, seed % 2 == 0 ? 9 : 5);
      for (const Edit& one : one_of_each()) {
        const EditResult alone = edited(texture, {one});
        CHECK_NOTHROW(validate(alone.texture));
        CHECK(spectral_radius(alone.texture.A) < 1);
      }
      const LinearDynamicTexture all = after(texture, one_of_each());
      CHECK(spectral_radius(all.A) < 1);
      CHECK(test::same(linear_dynamic_texture(to_archive(all)), all));
    }
  }
}

TEST_CASE("Weights lie apart from C and multiply in the three groups", "[dytex][edit]") {
  const LinearDynamicTexture texture = test::random_texture(20, 0.9, 3);
  const LinearDynamicTexture found =
      after(texture, {{Scales{2, 0.5, 3}}, {Weights{{0.5, 1, 4}}}, {Scales{1, 2, 1}}});
  CHECK(found.C == texture.C);
  CHECK(found.B == texture.B);
  for (int i = 0; i < 20; ++i) {
    const double scale = i < 5 ? 2 : i < 15 ? 1 : 3, own = i == 0 ? 0.5 : i == 2 ? 4 : 1;
    CHECK(found.weights[i] == scale * own);
  }
  const EditResult few = edited(test::random_texture(4, 0.9, 3), {{Scales{1, 1, 2}}});
  CHECK(few.notes == std::vector<std::string>{"the model has no fine components: it is of order 4"});
}

TEST_CASE("A list of edits is the edits one after another", "[dytex][edit]") {
  const LinearDynamicTexture texture = test::random_texture(8, 0.95, 8);
  LinearDynamicTexture step = texture;
  for (const Edit& one : one_of_each()) step = after(step, {one});
  CHECK(test::same(step, after(texture, one_of_each())));
}

TEST_CASE("Edits of different things may change places", "[dytex][edit]") {
  const LinearDynamicTexture texture = test::random_texture(8, 0.95, 8);
  const Edit speed{Speed{1.4}, false}, dim{Intensity{0.4}}, coarse{Scales{2, 1, 0.5}}, back{Reverse{}},
      flow{Flow{0.7}};
  for (const auto& [a, b] :
       {std::pair{speed, dim}, {speed, coarse}, {dim, coarse}, {back, dim}, {flow, dim}, {back, coarse}}) {
    const LinearDynamicTexture ab = after(texture, {a, b}), ba = after(texture, {b, a});
    CHECK(apart(ab.A, ba.A) < 1e-9);
    CHECK(apart(ab.B * ab.B.transpose(), ba.B * ba.B.transpose()) < 1e-8);
    CHECK(ab.weights == ba.weights);
  }
  // Speeds, and intensities, multiply; contrast is kept by what is shown then, so weights before speed do
  // count.
  CHECK(apart(after(texture, {{Speed{0.5}}, {Speed{0.6}}}).A, after(texture, {{Speed{0.3}}}).A) < 1e-10);
  CHECK(apart(after(texture, {{Intensity{0.5}}, {Intensity{3}}}).B, after(texture, {{Intensity{1.5}}}).B) <
        1e-14);
  CHECK(apart(after(texture, {coarse, {Speed{2}}}).B, after(texture, {{Speed{2}}, coarse}).B) > 1e-4);
}

TEST_CASE("Presets do what the paper's text says of its figures", "[dytex][edit]") {
  const std::map<std::string_view, double> speeds{
      {"fire: half the speed", 0.5}, {"fire: twice the speed", 2}, {"fire: backwards", -1}};
  CHECK(presets().size() == 16);
  for (const PresetInfo& info : presets()) {
    const std::vector<Edit> edits = preset(info.name);
    for (const Edit& one : edits) CHECK_NOTHROW(validate(one));
    const LinearDynamicTexture texture = test::random_texture(30, 0.95, 2);
    const LinearDynamicTexture found = after(texture, edits);
    const auto went = [&](double ratio, const std::string& what) {
      const auto at = info.about.find(what);
      const auto up = info.about.find("up", at), down = info.about.find("down", at);
      CHECK((ratio > 1) == (at != std::string_view::npos && up < down));
      CHECK((ratio < 1) == (at != std::string_view::npos && down < up));
    };
    if (info.name == "spray" || info.name == "frothy") continue;  // move more than their line names
    if (const auto speed = speeds.find(info.about); speed != speeds.end()) {
      CHECK(found.A == after(texture, {{Speed{speed->second}}}).A);
      continue;
    }
    went(found.B.norm() / texture.B.norm(), "intensity");
    went(found.weights[0], "coarse");
    went(found.weights[10], "medium");
    went(found.weights[29], "fine");
  }
  CHECK(test::message_of<core::InputError>([] { preset("stormy"); }) ==
        "preset is stormy; allowed is turbulent, hazy, billowing, patchy, rough-sea, lake, rain, spray, "
        "frothy, spurty, fire-coarse, fire-medium, fire-fine, fire-slow, fire-fast, fire-reversed");
}

TEST_CASE("Edits out of range are refused by name and value", "[dytex][edit]") {
  const LinearDynamicTexture texture = test::random_texture(3, 0.9, 1);
  const auto refused = [&](const Edit& one) {
    return test::message_of<core::InputError>([&] { edited(texture, {one}); });
  };
  CHECK(refused({Speed{3.5}}) == "speed is 3.5; allowed is -3 to 3");
  CHECK(refused({Speed{NAN}}) == "speed is not finite; allowed is -3 to 3");
  CHECK(refused({Flow{0.001}}) == "flow is 0.001; allowed is 0.01 to 100");
  CHECK(refused({Intensity{-1}}) == "intensity is -1; allowed is 0 to 3");
  CHECK(refused({Directions{{1, 4}}}) == "directions[1] is 4; allowed is 0 to 3");
  CHECK(refused({Directions{{1, 2, 3, 1}}}) == "directions has 4 numbers, Q has 3 eigenvalues");
  CHECK(refused({Scales{1, -2, 1}}) == "medium is -2; allowed is 0 to 10");
  CHECK(refused({Weights{{}}}) == "weights is empty, must have at least one number");
  CHECK(refused({Weights{{1, 1, 1, 1}}}) == "weights has 4 numbers, there are 3 components");
  LinearDynamicTexture unstable = texture;
  unstable.A *= 2;
  CHECK_THROWS_AS(edited(unstable, {{Speed{2}}}), core::InputError);
}

TEST_CASE("A model without components has nothing to edit", "[dytex][edit]") {
  LinearDynamicTexture texture = test::texture_of(MatrixXd(0, 0), MatrixXd(0, 0));
  const EditResult result = edited(texture, one_of_each());
  CHECK(test::same(result.texture, texture));
  CHECK(result.notes == std::vector<std::string>{"the model has no components: there is nothing to edit"});
}
