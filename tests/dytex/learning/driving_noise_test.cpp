// SPDX-License-Identifier: Apache-2.0
// What drives a texture: noise of fewer directions than the state has.
#include <cmath>

#include "core/error.hpp"
#include "dytex/distances/distances.hpp"
#include "dytex/editing/edit.hpp"
#include "dytex/estimation/forecast.hpp"
#include "dytex/learn.hpp"
#include "dytex/model/archive.hpp"
#include "dytex/model/compression.hpp"
#include "dytex/synthesize.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/matrices.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/reference_linalg.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

using dytex::LinearDynamicTexture;

constexpr int kDrivenWidth = 12, kDrivenHeight = 10;

/// A clip of levels driven by a system of four states and two inputs of variance 1.
struct Driven {
  Eigen::MatrixXd C, A, B;
  core::Clip clip;
};

Driven driven_clip(int frames, double frame_noise = 0, std::uint64_t seed = 3) {
  constexpr Eigen::Index kValues = Eigen::Index{kDrivenWidth} * kDrivenHeight;
  Driven made;
  made.C = orthonormal(kValues, 4, 7);
  const auto turn = [](double radius, double angle) -> Eigen::Matrix2d {
    return radius * Eigen::Matrix2d{{std::cos(angle), -std::sin(angle)}, {std::sin(angle), std::cos(angle)}};
  };
  made.A = Eigen::MatrixXd::Zero(4, 4);
  made.A.topLeftCorner(2, 2) = turn(0.8, 0.9);
  made.A.bottomRightCorner(2, 2) = turn(0.7, 0.4);
  made.B = 30 * normals(4, 2, 8);
  core::Rng rng(seed);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(4);
  Eigen::MatrixXd levels(kValues, frames);
  for (int t = -100; t < frames; ++t) {
    Eigen::Vector2d v;
    for (double& one : v) one = rng.normal();
    x = (made.A * x + made.B * v).eval();
    if (t < 0) continue;
    levels.col(t) = (made.C * x).array() + 128;
    for (Eigen::Index p = 0; p < kValues && frame_noise > 0; ++p) levels(p, t) += frame_noise * rng.normal();
  }
  made.clip = clip_of(levels, kDrivenWidth, kDrivenHeight, 1, CV_32F);
  return made;
}

LinearDynamicTexture learned_from(const core::Clip& clip, int rank) {
  core::ClipSource source(clip);
  dytex::LearnOptions options;
  options.components = 4;
  options.noise_rank = rank;
  return dytex::learn(source, options).texture;
}

/// What drove a clip drawn from the model, N × frames.
Eigen::MatrixXd drawn_innovations(const LinearDynamicTexture& texture, int frames) {
  dytex::Synthesis synthesis(texture, {});
  synthesis.next();
  Eigen::VectorXd before = synthesis.state();
  Eigen::MatrixXd result(texture.order(), frames);
  for (int t = 0; t < frames; ++t) {
    synthesis.next();
    result.col(t) = synthesis.state() - texture.A * before;
    before = synthesis.state();
  }
  return result;
}

}  // namespace

TEST_CASE("Noise of two directions is found with rank two", "[dytex][noise]") {
  constexpr int kFrames = 900;
  const Driven truth = driven_clip(kFrames);
  const LinearDynamicTexture texture = learned_from(truth.clip, 2);
  REQUIRE(texture.B.cols() == 2);
  CHECK(texture.B.rows() == 4);
  CHECK(texture.noise_share > 1 - 1e-5);  // the mean that was taken away moves a little, too
  // In the frames' coordinates, which the learned states share with the true ones.
  const Eigen::MatrixXd found = texture.C.cast<double>() * texture.B, real = truth.C * truth.B;
  const Eigen::MatrixXd span = orthonormal_columns(real);
  CHECK((found - span * (span.transpose() * found)).norm() < 1e-4 * found.norm());
  const Eigen::MatrixXd Q = found * found.transpose(), true_Q = real * real.transpose();
  CHECK((Q - true_Q).norm() < 5 / std::sqrt(double(kFrames)) * true_Q.norm());
  // What drives drawn clips lies there, too.
  const Eigen::MatrixXd drives = texture.C.cast<double>() * drawn_innovations(texture, 200);
  CHECK((drives - span * (span.transpose() * drives)).norm() < 1e-4 * drives.norm());
}

TEST_CASE("The rank's share is that of the strongest directions of the residuals", "[dytex][noise]") {
  const Driven truth = driven_clip(500, 6);
  const LinearDynamicTexture full = learned_from(truth.clip, 0);
  REQUIRE(full.B.cols() == 4);
  CHECK(full.noise_share == 1);
  const Eigen::MatrixXd Q = full.B * full.B.transpose();
  const Eigen::VectorXd values = symmetric_eigenvalues(Q);
  double sum = 0;
  for (int rank = 1; rank <= 4; ++rank) {
    CAPTURE(rank);
    const LinearDynamicTexture texture = learned_from(truth.clip, rank);
    REQUIRE(texture.B.cols() == rank);
    sum += values[4 - rank];
    CHECK_THAT(texture.noise_share, WithinRel(sum / values.sum(), 1e-9));
    // The best approximation of that rank (Eckart, Young 1936): what is left are the other eigenvalues.
    CHECK_THAT((Q - texture.B * texture.B.transpose()).norm(),
               WithinAbs(values.head(4 - rank).norm(), 1e-9 * values.norm()));
    CHECK(texture.A == full.A);
  }
}

TEST_CASE("All that a texture is for goes with noise of few directions", "[dytex][noise]") {
  const Driven truth = driven_clip(400, 3);
  const LinearDynamicTexture texture = learned_from(truth.clip, 2);
  CHECK(same(dytex::linear_dynamic_texture(dytex::to_archive(texture)), texture));
  // KL: another model of the same law is nearer than another system; of itself it is 0.
  const LinearDynamicTexture again = learned_from(driven_clip(400, 3, 77).clip, 2);
  LinearDynamicTexture other = texture;
  other.A *= 0.5;
  CHECK(dytex::kl_rate(texture, texture) == 0);
  CHECK(5 * dytex::kl_rate(again, texture) < dytex::kl_rate(other, texture));
  // Edits keep the states' covariance as they do of full noise.
  const Eigen::MatrixXd P = dytex::stationary_covariance(texture.A, texture.B);
  const std::vector<dytex::Edit> reversed{{dytex::Reverse{}}}, stronger{{dytex::Intensity{2.25}}};
  const auto back = dytex::edit(texture, reversed).texture;
  CHECK((dytex::stationary_covariance(back.A, back.B) - P).norm() < 1e-9 * P.norm());
  const auto strong = dytex::edit(texture, stronger).texture;
  CHECK(strong.B.cols() == 2);
  CHECK((dytex::stationary_covariance(strong.A, strong.B) - 2.25 * P).norm() < 1e-9 * P.norm());
  // A loop ends where it began, and a forecast widens to the stationary covariance.
  dytex::SynthesisOptions looped;
  looped.loop = 20;
  dytex::Synthesis loop(texture, looped);
  loop.next();
  const Eigen::VectorXd begin = loop.state();
  for (int t = 0; t < 20; ++t) loop.next();
  CHECK(loop.state() == begin);
  const auto forecast = dytex::forecast(texture, {texture.states.col(0), Eigen::MatrixXd::Zero(4, 4)}, 200);
  CHECK_THAT(forecast.error[199],
             WithinRel(std::sqrt(P.trace() / double(texture.pixels()) + texture.r), 1e-6));
  CHECK(dytex::rounded(texture, dytex::Precision::f16).B == texture.B);
  CHECK(dytex::stored_bytes(texture, 4, dytex::Precision::f32) + 8 * 2 * 4 ==
        dytex::stored_bytes(learned_from(truth.clip, 0), 4, dytex::Precision::f32));
}

TEST_CASE("A rank of the noise that cannot be is refused, one above all is told", "[dytex][noise]") {
  const Driven truth = driven_clip(60);
  core::ClipSource source(truth.clip);
  dytex::LearnOptions options;
  options.components = 4;
  for (const int bad : {-1, 5}) {
    options.noise_rank = bad;
    CHECK(message_of<core::InputError>([&] { dytex::learn(source, options); }) ==
          "LearnOptions.noise_rank is " + std::to_string(bad) + "; allowed is 0 to 4");
  }
  options.energy = 0.5;
  options.noise_rank = -1;
  CHECK(
      message_of<core::InputError>([&] { options.validate(); }).starts_with("LearnOptions.noise_rank is -1"));
  options.noise_rank = 5;
  const auto learned = dytex::learn(source, options);
  REQUIRE(learned.texture.B.cols() < 5);
  CHECK(std::ranges::any_of(learned.notes, [](const std::string& note) {
    return note.find("5 were asked for: all are kept") != std::string::npos;
  }));
  CHECK(learned.texture.noise_share == 1);
}

TEST_CASE("A share of the noise that cannot be is refused", "[dytex][noise]") {
  LinearDynamicTexture texture = learned_from(driven_clip(60).clip, 2);
  texture.noise_share = 0;
  CHECK(message_of<core::InputError>([&] {
          dytex::validate(texture);
        }).starts_with("texture: noise_share is 0"));
}
