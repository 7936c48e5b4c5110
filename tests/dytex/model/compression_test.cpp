// SPDX-License-Identifier: Apache-2.0
#include "dytex/model/compression.hpp"

#include <cmath>
#include <sstream>

#include "core/error.hpp"
#include "dytex/learn.hpp"
#include "dytex/measures/psnr.hpp"
#include "dytex/model/archive.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/linear_textures.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/reference_linalg.hpp"

using namespace emberfold;
using namespace emberfold::test;
using dytex::Precision;

namespace {

core::Clip clip(int depth = CV_8U, int channels = 1) {
  return test::wavy_clip(24, 18, channels, depth, 30);
}

dytex::LinearDynamicTexture learned(const core::Clip& clip, int components) {
  core::ClipSource source(clip);
  dytex::LearnOptions options;
  options.components = components;
  return dytex::learn(source, options).texture;
}

core::ModelArchive through_files(core::ModelArchive archive) {
  for (auto& [name, array] : archive.arrays) {
    std::stringstream file;
    core::write_npy(file, array);
    array = core::read_npy(file);
  }
  return archive;
}

double largest(const Eigen::MatrixXf& matrix) {
  return static_cast<double>(matrix.cwiseAbs().maxCoeff());
}

}  // namespace

TEST_CASE("A texture comes back from each precision as exactly as it tells", "[dytex][compress]") {
  for (const int channels : {1, 3}) {
    const auto texture = learned(clip(CV_8U, channels), 6);
    const auto read = [&](Precision precision) {
      return dytex::linear_dynamic_texture(through_files(dytex::to_archive(texture, precision)));
    };
    CHECK(test::same(read(Precision::f32), texture));
    for (const Precision precision : {Precision::f16, Precision::u8}) {
      CAPTURE(dytex::name(precision));
      auto back = read(precision);
      CHECK(test::same(back, dytex::rounded(texture, precision)));
      CHECK(largest(back.mean - texture.mean) <= 255 * std::pow(2.0, -11) / 2 + 1e-6);
      CHECK(largest(back.mean - texture.mean) > 0);
      for (Eigen::Index i = 0; i < texture.components(); ++i) {
        const double range = static_cast<double>(texture.C.col(i).maxCoeff() - texture.C.col(i).minCoeff());
        const double allowed = precision == Precision::u8 ? range / 510 * (1 + 1e-4)
                                                          : largest(texture.C.col(i)) * std::pow(2.0, -11);
        CHECK(largest(back.C.col(i) - texture.C.col(i)) <= allowed);
        CHECK(largest(back.C.col(i) - texture.C.col(i)) > allowed / 20);
      }
      back.C = texture.C;
      back.mean = texture.mean;
      CHECK(test::same(back, texture));  // nothing else is rounded
    }
  }
}

TEST_CASE("Projection errors are those of every frame by itself", "[dytex][compress]") {
  for (const int depth : {CV_8U, CV_32F}) {
    const core::Clip frames = clip(depth);
    const Eigen::MatrixXd levels = test::levels_of(frames);
    const auto texture = learned(frames, 10);
    for (const Precision precision : dytex::kPrecisions) {
      CAPTURE(dytex::name(precision), depth);
      const auto kept = dytex::rounded(texture, precision);
      const Eigen::VectorXd errors = dytex::projection_errors(texture, precision);
      REQUIRE(errors.size() == 11);
      const Eigen::MatrixXd away = levels.colwise() - kept.mean.cast<double>();
      for (const Eigen::Index n : {0, 1, 4, 10}) {
        const Eigen::MatrixXd C = kept.C.leftCols(n).cast<double>();
        Eigen::MatrixXd left = away;
        if (n > 0) left -= C * test::least_squares(C, away);
        CHECK_THAT(errors[n], WithinRel(left.squaredNorm() / static_cast<double>(left.size()), 1e-3));
      }
      CHECK((errors.tail(10) - errors.head(10)).maxCoeff() <= 0);
    }
  }
}

TEST_CASE("The measured error is that of the drawn frames in 8 bits", "[dytex][compress]") {
  const core::Clip frames = clip();  // 30 frames: no whole number of batches
  const Eigen::MatrixXd levels = test::levels_of(frames);
  auto texture = learned(frames, 7);
  core::ClipSource source(frames);
  source.next();  // it is read from its beginning all the same
  const double measured = dytex::measured_error(texture, source);
  const Eigen::MatrixXd C = texture.C.cast<double>(), mean = texture.mean.cast<double>();
  const Eigen::MatrixXd states = test::least_squares(C, levels.colwise() - mean.col(0));
  const Eigen::MatrixXd drawn =
      ((C * states).colwise() + mean.col(0)).array().max(0.0).min(255.0).round().matrix();
  CHECK_THAT(measured, WithinRel((drawn - levels).squaredNorm() / static_cast<double>(levels.size()), 1e-3));
  CHECK_THAT(measured, WithinAbs(dytex::projection_errors(texture, Precision::f32)[7] + 1.0 / 12, 0.05));
  texture.weights *= 3;  // an edit does not change what was learned
  CHECK(dytex::measured_error(texture, source) == measured);

  core::Clip other = frames;
  other.frames.pop_back();
  core::ClipSource shorter(other);
  CHECK(test::message_of<core::InputError>([&] { dytex::measured_error(texture, shorter); }) ==
        "the clip has 29 frames, the model was learned from 30");
  const core::Clip wide = test::wavy_clip(25, 18, 1, CV_8U, 30);
  core::ClipSource wider(wide);
  CHECK(test::message_of<core::InputError>([&] { dytex::measured_error(texture, wider); }) ==
        "the clip's frames are 25×18 in grey, the model's 24×18 in grey");
}

TEST_CASE("A coarser model is smaller and a little worse", "[dytex][compress]") {
  const auto texture = learned(clip(CV_8U, 3), 8);
  double before = -1;
  std::size_t larger = 1 << 30;
  for (const Precision precision : dytex::kPrecisions) {
    const double error = dytex::projection_errors(texture, precision)[8];
    CHECK(error > before);
    before = error;
    std::size_t numbers = 0;
    for (const auto& [name, array] : dytex::to_archive(texture, precision).arrays)
      numbers += std::visit([](const auto& v) { return v.size() * sizeof(v[0]); }, array.data);
    CHECK(dytex::stored_bytes(texture, 8, precision) == numbers);
    CHECK(numbers < larger);
    larger = numbers;
    // One component less: a column of C and what the dynamics hold of it.
    const std::size_t step =
        dytex::stored_bytes(texture, 8, precision) - dytex::stored_bytes(texture, 7, precision);
    const std::size_t value = precision == Precision::f32 ? 4 : precision == Precision::f16 ? 2 : 1;
    CHECK(step >= value * 24 * 18 * 3);
    CHECK(step < value * 24 * 18 * 3 + 8 * (64 + 30));
  }
  CHECK(test::message_of<core::InputError>([&] { dytex::stored_bytes(texture, 9, Precision::f32); }) ==
        "components is 9; allowed is 0 to 8");
  CHECK_THAT(dytex::psnr(255.0 * 255.0 / 1000), WithinRel(30.0, 1e-12));
  CHECK(dytex::psnr(0) == 100);
}

TEST_CASE("A texture that stands still is kept in each precision", "[dytex][compress]") {
  const core::Clip still = test::clip_of(Eigen::MatrixXd::Constant(12, 5, 77), 4, 3, 1, CV_8U);
  const auto texture = learned(still, 2);
  REQUIRE(texture.components() == 0);
  core::ClipSource source(still);
  for (const Precision precision : dytex::kPrecisions) {
    CHECK(test::same(dytex::rounded(texture, precision), texture));  // 77 is a half
    CHECK(dytex::projection_errors(texture, precision)[0] == 0);
    CHECK(dytex::measured_error(texture, source) == 0);
  }
}

TEST_CASE("What is not whole or not in range is refused", "[dytex][compress]") {
  auto texture = learned(clip(), 4);
  const auto refusal = [&](Precision precision, const auto& damage) {
    auto archive = dytex::to_archive(texture, precision);
    damage(archive.arrays);
    return test::message_of<core::IoError>([&] { dytex::linear_dynamic_texture(archive); });
  };
  CHECK(refusal(Precision::u8, [](auto& arrays) { arrays.erase("C_scale"); }) ==
        "model: the array C_scale is missing");
  CHECK(refusal(Precision::u8, [](auto& arrays) {
          arrays["C_offset"].shape = {2, 2};
        }) == "model: the array C_offset has the shape (2, 2), must have (4,)");
  CHECK(refusal(Precision::u8, [](auto& arrays) {
          std::get<std::vector<float>>(arrays["C_scale"].data)[1] = std::numeric_limits<float>::infinity();
        }) == "model: texture: C has a value that is not finite");
  CHECK(refusal(Precision::f16, [](auto& arrays) {
          arrays["C"].shape = {4, 432};
        }) == "model: the array C has the shape (4, 432), must have (432, 4)");
  CHECK(refusal(Precision::f16, [](auto& arrays) {
          std::get<std::vector<core::Half>>(arrays["mean"].data)[0] = {0x7c00};
        }) == "model: texture: mean has a value that is not finite");
  CHECK(refusal(Precision::u8, [](auto& arrays) { arrays["C"].data = std::vector<double>(4 * 432); }) ==
        "model: the array C must hold float32, float16 or uint8");
  texture.mean[5] = 70'000;
  CHECK(test::message_of<core::InputError>([&] { dytex::to_archive(texture, Precision::f16); }) ==
        "mean has a value beyond 65504, the most that f16 holds; keep f32");
  CHECK(dytex::precision_of("f16") == Precision::f16);
  CHECK_FALSE(dytex::precision_of("f64"));
}
