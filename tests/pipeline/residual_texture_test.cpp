// SPDX-License-Identifier: Apache-2.0
#include "pipeline/residual_texture.hpp"

#include <cmath>
#include <limits>
#include <stop_token>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "core/context.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "pipeline/frame_synthesis.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/drawn_models.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

const cv::Size kSize(112, 80);
constexpr int kResidualFrames = 30;

graph::AttributeGraph bar() {
  std::vector<graph::Vertex> vertices;
  for (std::uint32_t i = 0; i < 12; ++i) {
    graph::Patch patch;
    patch.position = {50, 5 + 6.0 * i};
    patch.theta = 1.5707963;
    patch.width = 4, patch.blur = 1, patch.contrast = 60;
    patch.left = patch.right = {90, 90, 90}, patch.middle = {150, 150, 150};
    vertices.push_back({{i}, {}, patch});
  }
  return {vertices, {}};
}

sketch::RenderOptions look(int channels) {
  sketch::RenderOptions look{kSize, channels};
  look.empty_level = 90;
  return look;
}

/// Noise of SD 6 left of the bar, 2 right of it, new in each frame; twice as much of it in red as in green
/// and none in blue; and the right 4 levels above what is drawn, which is no texture.
core::Clip noisy(int channels) {
  core::Clip clip{{kSize.width, kSize.height, channels, CV_8U, 25, 255, kResidualFrames}, {}};
  const cv::Mat drawn = sketch::render_frame(bar(), look(channels));
  core::Rng rng(17);
  for (int t = 0; t < kResidualFrames; ++t) {
    cv::Mat frame = drawn.clone();
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        const double noise = (x < 50 ? 6 : 2) * rng.normal(), more = x < 50 ? 0 : 4;
        for (int c = 0; c < channels; ++c) {
          auto& value = frame.ptr(y)[x * channels + c];
          value = cv::saturate_cast<uchar>(value + more + noise * (channels == 1 ? 1 : c));
        }
      }
    clip.frames.push_back(frame);
  }
  return clip;
}

pipeline::ResidualTexture measured(const core::Clip& clip) {
  core::ClipSource source(clip);
  return pipeline::measure_residual(source, std::vector(clip.frames.size(), bar()), look(clip.info.channels),
                                    {});
}

struct Seen {
  std::vector<double> mean, deviation;
};
/// Mean and SD of each channel over the frames in a rectangle.
Seen seen_in(const std::vector<cv::Mat>& frames, const cv::Rect& where) {
  Seen seen;
  const auto channels = static_cast<std::size_t>(frames[0].channels());
  std::vector<double> sums(channels), squares(channels);
  for (const auto& frame : frames) {
    cv::Mat values;
    frame(where).convertTo(values, CV_32F);
    const cv::Scalar sum = cv::sum(values), square = cv::sum(values.mul(values));
    for (std::size_t c = 0; c < channels; ++c)
      sums[c] += sum[static_cast<int>(c)], squares[c] += square[static_cast<int>(c)];
  }
  const double count = static_cast<double>(where.area()) * static_cast<double>(frames.size());
  for (std::size_t c = 0; c < channels; ++c) {
    seen.mean.push_back(sums[c] / count);
    seen.deviation.push_back(std::sqrt(squares[c] / count - seen.mean[c] * seen.mean[c]));
  }
  return seen;
}

std::vector<cv::Mat> drawn(const pipeline::ResidualTexture& residual, int count, std::uint64_t seed = 1) {
  pipeline::ResidualFrames frames(residual, kSize, seed);
  std::vector<cv::Mat> all;
  for (int t = 0; t < count; ++t) all.push_back(frames.next());
  return all;
}

}  // namespace

TEST_CASE("Residual: new frames are as strong and as coloured where the clip's are") {
  for (const int channels : {1, 3}) {
    CAPTURE(channels);
    const auto frames = drawn(measured(noisy(channels)), 60);
    REQUIRE(frames[0].type() == CV_MAKETYPE(CV_8S, channels));
    const auto left = seen_in(frames, {2, 2, 28, 76}), right = seen_in(frames, {74, 2, 36, 76});
    for (int c = 0; c < channels; ++c) {
      const auto i = static_cast<std::size_t>(c);
      const double share = channels == 1 ? 1 : c;
      CAPTURE(c);
      CHECK_THAT(left.deviation[i], WithinAbs(6 * share, 0.5 + 0.3 * share));
      CHECK_THAT(right.deviation[i], WithinAbs(2 * share, 0.4 + 0.2 * share));
      CHECK_THAT(left.mean[i], WithinAbs(0, 0.5));
      CHECK_THAT(right.mean[i], WithinAbs(0, 0.5));
    }
  }
}

TEST_CASE("Residual: what is near patches does not count, and a clip as it is drawn has none") {
  auto clip = noisy(1);
  for (auto& frame : clip.frames) frame(cv::Rect(47, 10, 7, 56)).setTo(255);
  const auto same = measured(clip), other = measured(noisy(1));
  CHECK(cv::norm(same.strength, other.strength, cv::NORM_INF) < 0.5);
  for (auto& frame : clip.frames) frame = sketch::render_frame(bar(), look(1));
  for (const auto& frame : drawn(measured(clip), 3)) CHECK(cv::norm(frame, cv::NORM_INF) == 0);
  clip.frames.resize(1);
  CHECK(measured(clip).empty());
}

TEST_CASE("Residual: the same frames at any number of threads, others by seed") {
  const auto residual = measured(noisy(3));
  const auto frames = drawn(residual, 4), others = drawn(residual, 4, 2);
  const core::ThreadLimit one(1);
  const auto again = drawn(residual, 4);
  for (std::size_t t = 0; t < 4; ++t) CHECK(same_pixels(frames[t], again[t]));
  CHECK_FALSE(same_pixels(frames[3], others[3]));
  CHECK_FALSE(same_pixels(frames[2], frames[3]));
}

TEST_CASE("Residual: lies on the frames that strokes alone would give") {
  const auto model = made_model(kSize.width, kSize.height, 16);
  pipeline::ResidualTexture residual = measured(noisy(3));
  auto seen = pipeline::render_options(model, {});
  const auto plain = pipeline::FrameSynthesis(mcmc::Synthesis(model, 1), seen).next(3);
  const auto grained = pipeline::residual_frames(model, residual, seen, 1).next(3);
  const auto grain = drawn(residual, 3);
  for (std::size_t t = 0; t < 3; ++t) {
    cv::Mat difference;
    cv::subtract(grained[t], plain[t], difference, cv::noArray(), CV_16S);
    cv::Mat rest;
    cv::subtract(difference, grain[t], rest, cv::noArray(), CV_16S);
    CHECK(cv::norm(rest, cv::NORM_INF) <= 1);
  }
  // A backdrop keeps still.
  seen.background = sketch::estimate_background(
      std::vector{sketch::measure_background(cv::Mat(kSize, CV_32FC3, cv::Scalar::all(90)), {})});
  seen.background.static_pixels = {cv::Mat(kSize, CV_8UC3, cv::Scalar::all(40)),
                                   cv::Mat::zeros(kSize, CV_8U)};
  seen.background.static_pixels.still.rowRange(0, 30) = 255;
  for (const auto& frame : pipeline::residual_frames(model, residual, seen, 1).next(2)) {
    CHECK(cv::norm(frame.rowRange(0, 24), cv::Mat(24, kSize.width, CV_8UC3, cv::Scalar::all(40)),
                   cv::NORM_INF) == 0);
  }
}

TEST_CASE("Residual: stops where it is told to, and is kept beside a model bit by bit") {
  const auto clip = noisy(3);
  std::stop_source stop;
  stop.request_stop();
  core::ClipSource source(clip);
  CHECK_THROWS_AS(pipeline::measure_residual(source, std::vector(clip.frames.size(), bar()), look(3),
                                             core::Context(stop.get_token())),
                  core::Cancelled);

  for (const int channels : {1, 3}) {
    const auto residual = measured(noisy(channels));
    core::ModelArchive archive;
    CHECK(pipeline::read_residual(archive, kSize).empty());
    pipeline::add_residual(archive, residual);
    const auto again = drawn(pipeline::read_residual(archive, kSize), 2), frames = drawn(residual, 2);
    for (std::size_t t = 0; t < 2; ++t) CHECK(same_pixels(frames[t], again[t]));
    const auto refusal = [&](const core::ModelArchive& from, cv::Size frame = kSize) {
      return message_of<core::IoError>([&] { pipeline::read_residual(from, frame); });
    };
    CHECK_THAT(refusal(archive, {200, 80}),
               Catch::Matchers::Contains("residual_strength.npy is 5 x 7 x 1;") &&
                   Catch::Matchers::Contains("expected float32, 5 x 13 x 1"));
    for (const char* name : {"colours", "strength", "ahead"}) {
      auto broken = archive;
      broken.arrays.erase("residual_" + std::string(name));
      CHECK(refusal(broken) == "motion model: residual_" + std::string(name) + ".npy is missing");
    }
    auto broken = archive;
    std::get<std::vector<float>>(broken.arrays["residual_strength"].data)[2] = -1;
    CHECK_THAT(refusal(broken), Catch::Matchers::Contains("residual_strength.npy holds a number below 0"));
    broken = archive;
    std::get<std::vector<float>>(broken.arrays["residual_within"].data)[2] =
        std::numeric_limits<float>::infinity();
    CHECK_THAT(refusal(broken), Catch::Matchers::Contains("not finite"));
  }
}
