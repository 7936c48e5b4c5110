// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/rng.hpp"
#include "dytex/distances/distances.hpp"
#include "dytex/distances/window_bands.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/linear_textures.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;

namespace {

/// A made texture: plane waves of random phase about one frequency.
struct Waves {
  double fx = 0.1, fy = 0.05;  // cycles a pixel
  double speed = 0.1;          // cycles a frame; above 0 it runs to smaller x and y where fx, fy > 0
  double spread = 0.2;         // of all three, as a share
};

core::Clip made_clip(const Waves& waves, std::uint64_t seed, cv::Size size, int frames = 48,
                     double contrast = 20, double brightness = 128) {
  constexpr int kWaves = 40;
  core::Rng rng(seed);
  core::Clip clip{{size.width, size.height, 1, CV_32F, 25, 255, frames}, {}};
  std::vector<std::array<double, 4>> parts;
  for (int k = 0; k < kWaves; ++k) {
    const auto near = [&](double f) { return f * (1 + waves.spread * rng.normal()); };
    const double fx = near(waves.fx), fy = near(waves.fy), ft = near(waves.speed);
    parts.push_back({fx, fy, ft, rng.uniform(0, 1)});
  }
  for (int t = 0; t < frames; ++t) {
    cv::Mat1f levels(size, static_cast<float>(brightness));
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        for (const auto& [fx, fy, ft, phase] : parts)
          levels(y, x) +=
              static_cast<float>(contrast * std::sqrt(2.0 / kWaves) *
                                 std::cos(2 * std::numbers::pi * (fx * x + fy * y + ft * t + phase)));
    clip.frames.push_back(levels);
  }
  return clip;
}

dytex::WindowSpectrum described(const core::Clip& clip) {
  core::ClipSource source(clip);
  return dytex::window_spectrum(source);
}

core::Clip changed(core::Clip clip, const std::function<cv::Mat(const cv::Mat&)>& change) {
  for (auto& frame : clip.frames) frame = change(frame);
  clip.info.width = clip.frames[0].cols;
  clip.info.height = clip.frames[0].rows;
  return clip;
}

}  // namespace

TEST_CASE("A texture is known elsewhere, in frames of another size, and with other contrast",
          "[dytex][windows]") {
  const std::vector<Waves> kinds{
      {0.1, 0.05, 0.1}, {0.1, 0.05, 0.3}, {0.25, 0.1, 0.1}, {0.05, 0.2, 0.1}, {0.05, 0.2, -0.1}};
  std::vector<dytex::WindowSpectrum> known, asked;
  for (const auto& kind : kinds) {
    known.push_back(described(made_clip(kind, 1, {64, 48})));
    asked.push_back(described(made_clip(kind, 2, {48, 80}, 60, 5, 60)));
    REQUIRE(known.back());
    REQUIRE(asked.back());
  }
  for (std::size_t i = 0; i < kinds.size(); ++i)
    for (std::size_t j = 0; j < kinds.size(); ++j) {
      CAPTURE(i, j);
      const double own = dytex::window_distance(*known[i], *asked[i]);
      if (i != j) CHECK(1.4 * own < dytex::window_distance(*known[j], *asked[i]));
    }
}

TEST_CASE("Brightness, contrast and mirroring change nothing, turning and reversal do", "[dytex][windows]") {
  const core::Clip clip = made_clip({0.12, 0.08, 0.12}, 3, {48, 48});
  const auto found = described(clip);
  REQUIRE(found);
  CHECK(found->size() == 112);
  const auto apart = [&](const core::Clip& other) {
    return dytex::window_distance(*found, *described(other));
  };
  CHECK(apart(clip) == 0);
  CHECK(apart(changed(clip, [](const cv::Mat& f) -> cv::Mat { return f * 0.2 + 90; })) < 0.05);
  CHECK(apart(changed(clip, [](const cv::Mat& f) {
          cv::Mat mirrored;
          cv::flip(f, mirrored, 1);
          return mirrored;
        })) < 0.05);
  CHECK(apart(changed(clip, [](const cv::Mat& f) -> cv::Mat { return f.t(); })) > 1);
  core::Clip reversed = clip;
  std::ranges::reverse(reversed.frames);
  CHECK(apart(reversed) > 1);
}

TEST_CASE("A clip is described from its first frame, wherever its source stands", "[dytex][windows]") {
  const core::Clip clip = made_clip({0.12, 0.08, 0.12}, 3, {32, 32});
  core::ClipSource source(clip);
  source.next();
  const auto once = dytex::window_spectrum(source), again = dytex::window_spectrum(source);
  REQUIRE((once && again));
  CHECK(*once == *described(clip));
  CHECK(*again == *once);
}

TEST_CASE("Windows lie in the middle of a frame, octaves of time begin at powers of two",
          "[dytex][windows]") {
  using dytex::detail::window_starts;
  CHECK(window_starts(15, 16).empty());
  CHECK(window_starts(16, 16) == std::vector<int>{0});
  CHECK(window_starts(31, 16) == std::vector<int>{7});
  CHECK(window_starts(32, 16) == std::vector<int>{0, 16});
  CHECK(window_starts(58, 16) == std::vector<int>{5, 21, 37});
  CHECK(window_starts(100, 32) == std::vector<int>{10, 42, 74});
  const std::vector<int> octaves{0, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 3, 3, 3, 3};
  for (int cycles = 1; cycles <= 15; ++cycles)
    CHECK(dytex::detail::time_band(cycles) == octaves[static_cast<std::size_t>(cycles - 1)]);
  CHECK(dytex::detail::window_step(512, 512) == 16);
  CHECK(dytex::detail::window_step(528, 512) == 32);
}

TEST_CASE("Segments of 32 frames overlap by half, what is left at the end does not count",
          "[dytex][windows]") {
  core::Clip clip = made_clip({0.12, 0.08, 0.12}, 3, {32, 32}, 80);
  const core::Clip other = made_clip({0.25, 0.1, 0.3}, 4, {32, 32}, 80);
  std::copy(other.frames.begin() + 32, other.frames.end(), clip.frames.begin() + 32);
  const auto beginning = [&](std::size_t frames) {
    core::Clip part = clip;
    part.frames.resize(frames);
    return *described(part);
  };
  CHECK(beginning(47) == beginning(32));
  CHECK(beginning(48) != beginning(32));
  CHECK(beginning(63) == beginning(48));
  CHECK(beginning(64) != beginning(48));
}

TEST_CASE("Noise that is fainter than rounding has no description, however long it lasts",
          "[dytex][windows]") {
  for (const auto& [sd, is_seen] : {std::pair(0.004, false), {0.04, true}}) {
    core::Rng rng(5);
    dytex::WindowEnergies energies({48, 32});
    for (int t = 0; t < 32 * 12; ++t) {
      cv::Mat1f luma(32, 48);
      for (float& level : luma) level = static_cast<float>(sd * rng.normal());
      energies.add(luma);
      if (t % 64 == 63) CHECK(energies.spectrum().has_value() == is_seen);
    }
  }
}

TEST_CASE("What has no windows has no description", "[dytex][windows]") {
  CHECK_FALSE(described(made_clip({}, 1, {15, 40})));
  CHECK_FALSE(described(made_clip({}, 1, {40, 40}, 31)));
  CHECK(described(made_clip({}, 1, {16, 16}, 32)));
  CHECK_FALSE(described(made_clip({}, 1, {40, 40}, 40, 0, 255)));
  const auto still = test::made_texture(20, 20, 0, 1), moving = test::made_texture(20, 20, 2, 1);
  CHECK_FALSE(dytex::window_spectrum(still));
  CHECK_FALSE(dytex::window_spectrum(test::made_texture(20, 15, 2, 1)));
  const auto pair = dytex::distances(still, moving);
  CHECK_FALSE(has(pair, dytex::Measure::windows));
  CHECK(test::message_of<core::InputError>([&] { distance(pair, dytex::Measure::windows); }) ==
        "a texture has no windows that move: frames are at least 16x16, clips 32 frames");
  CHECK_FALSE(test::message_of<core::InputError>([&] { dytex::WindowEnergies({0, 4}); }).empty());
  dytex::WindowEnergies energies({20, 20});
  CHECK_FALSE(test::message_of<core::InputError>([&] { energies.add(cv::Mat1f(20, 21, 0.0F)); }).empty());
  CHECK_FALSE(test::message_of<core::InputError>([&] { energies.add(cv::Mat1b(20, 20, uchar{0})); }).empty());
  CHECK_FALSE(test::message_of<core::InputError>([&] {
                dytex::window_distance(Eigen::VectorXd(3), Eigen::VectorXd(2));
              }).empty());
}

TEST_CASE("A model's windows are those of the clips drawn from it", "[dytex][windows]") {
  // In colour, with weights and a noise of its own: what frames show must count.
  auto model = test::made_texture(32, 32, 3, 7, 0.85, 5);
  for (const int channels : {1, 3}) {
    if (channels == 3) {
      model = test::made_texture(96, 32, 3, 8, 0.85);
      model.info.width = 32;
      model.info.channels = 3;
    }
    model.C *= 30;
    model.weights[1] = 1.5;
    model.mean.setConstant(128);
    model.info.white = 255;
    model.info.depth = CV_32F;
    const auto exact = dytex::window_spectrum(model);
    REQUIRE(exact);
    dytex::WindowEnergies energies({32, 32});
    core::Rng rng(9);
    Eigen::VectorXd state = Eigen::VectorXd::Zero(model.order());
    for (int t = -100; t < 6000; ++t) {
      Eigen::VectorXd drive(model.B.cols());
      for (double& v : drive) v = rng.normal();
      state = model.A * state + model.B * drive;
      if (t < 0) continue;
      Eigen::VectorXf frame =
          model.mean + model.C * (model.weights.asDiagonal() * state.head(model.components())).cast<float>();
      for (float& v : frame) v += static_cast<float>(std::sqrt(model.r) * rng.normal());
      energies.add(core::luma(cv::Mat(32, 32, CV_32FC(channels), frame.data())).clone());
    }
    CAPTURE(channels);
    CHECK(dytex::window_distance(*exact, *energies.spectrum()) < 0.25);
  }
}

TEST_CASE("The windows' description does not depend on threads", "[dytex][windows]") {
  const core::Clip clip = made_clip({}, 4, {160, 96}, 40);
  const auto model = test::made_texture(64, 64, 4, 2);
  std::vector<Eigen::VectorXd> clips, models;
  for (const std::size_t threads : {1, 2, 5}) {
    const core::ThreadLimit limit(threads);
    clips.push_back(*described(clip));
    models.push_back(*dytex::window_spectrum(model));
  }
  for (std::size_t i = 1; i < clips.size(); ++i) {
    CHECK(clips[i] == clips[0]);
    CHECK(models[i] == models[0]);
  }
}

TEST_CASE("Distances of clips' windows take the place of the models'", "[dytex][windows]") {
  std::vector<dytex::LinearDynamicTexture> models{test::made_texture(16, 16, 2, 1),
                                                  test::made_texture(16, 16, 2, 2)};
  std::vector<dytex::WindowSpectrum> windows{Eigen::VectorXd::Constant(3, 1),
                                             Eigen::VectorXd::Constant(3, 3)};
  const auto own = dytex::all_distances(models);
  CHECK(*own[1].windows == *dytex::distances(models[0], models[1]).windows);
  CHECK(*own[0].windows == 0);
  CHECK(*dytex::all_distances(std::vector{models[1], models[0]})[1].windows == *own[1].windows);
  CHECK(*dytex::all_distances(models, {}, windows)[1].windows == 2);
  windows[0].reset();
  const auto lacking = dytex::all_distances(models, {}, windows);
  CHECK_FALSE(lacking[0].windows);
  CHECK_FALSE(lacking[1].windows);
  CHECK(*lacking[2].windows == 0);
  windows.pop_back();
  CHECK_FALSE(test::message_of<core::InputError>([&] { dytex::all_distances(models, {}, windows); }).empty());
}
