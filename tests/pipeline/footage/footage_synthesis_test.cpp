// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/footage_synthesis.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <stop_token>
#include <vector>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/rng.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/drawn_frames.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;
using pipeline::FootageSynthesis;
using pipeline::FootageSynthesisOptions;

namespace {

const cv::Size kSize(96, 72);

/// Waves that travel to the right, a picture without motion below them.
std::vector<cv::Mat> travelling_waves(int frames, int channels = 1) {
  std::vector<cv::Mat> clip;
  core::Rng rng(4);
  cv::Mat1b ground(kSize);
  for (auto& level : ground) level = static_cast<std::uint8_t>(60 + rng.below(120));
  for (int t = 0; t < frames; ++t) {
    cv::Mat frame(kSize, CV_8UC(channels));
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        const double phase = 2 * std::numbers::pi * ((x - 1.5 * t) / 24.0 + 0.05 * std::sin(y / 9.0));
        const double level = y < 48 ? 128 + 90 * std::sin(phase) : double(ground(y, x));
        for (int c = 0; c < channels; ++c)
          frame.ptr<std::uint8_t>(y)[x * channels + c] = cv::saturate_cast<std::uint8_t>(level - 20 * c);
      }
    clip.push_back(frame);
  }
  return clip;
}

std::vector<cv::Mat> draw(const std::vector<cv::Mat>& footage, const FootageSynthesisOptions& options,
                          int count) {
  FootageSynthesis synthesis(footage, options);
  return test::draw(synthesis, count);
}

/// Displacement to the right from a frame to the next, px, by the phase of the travelling_waves' first
/// harmonic in a row.
double step(const cv::Mat& a, const cv::Mat& b, int row) {
  const auto phase = [&](const cv::Mat& frame) {
    double re = 0, im = 0;
    for (int x = 0; x < frame.cols; ++x) {
      re += frame.at<std::uint8_t>(row, x) * std::cos(2 * std::numbers::pi * x / 24);
      im += frame.at<std::uint8_t>(row, x) * std::sin(2 * std::numbers::pi * x / 24);
    }
    return std::atan2(im, re);
  };
  return std::remainder(phase(b) - phase(a), 2 * std::numbers::pi) * 24 / (2 * std::numbers::pi);
}

double mean_step(const std::vector<cv::Mat>& frames) {
  double sum = 0;
  for (std::size_t t = 1; t < frames.size(); ++t)
    sum += step(frames[t - 1], frames[t], 24) / double(frames.size() - 1);
  return sum;
}

}  // namespace

TEST_CASE(
    "footage synthesis: travelling_waves travel as in the clip, at its contrast, and what stands still is "
    "kept") {
  const int channels = GENERATE(1, 3);
  const auto footage = travelling_waves(80, channels);
  FootageSynthesis synthesis(footage, {.seed = 3});
  CHECK(synthesis.amplitude() > 0.5);
  CHECK(synthesis.copied_share() == 0);
  const auto frames = draw(synthesis, 120);
  REQUIRE(frames.size() == 120);
  CHECK(synthesis.copied_share() > 0.01);
  CHECK(synthesis.copied_share() < 0.7);
  const cv::Rect still(0, 54, kSize.width, kSize.height - 54), moving(0, 4, kSize.width, 40);
  cv::Scalar mean, wanted_mean, deviation, wanted;
  for (const auto& frame : frames) {
    CHECK(cv::norm(frame(still), footage.front()(still), cv::NORM_INF) <= 1);
    cv::meanStdDev(frame(moving), mean, deviation);
    cv::meanStdDev(footage.front()(moving), wanted_mean, wanted);
    CHECK(deviation[0] == Approx(wanted[0]).epsilon(0.08));
  }
  if (channels == 1) CHECK(mean_step(frames) == Approx(1.5).margin(0.1));
}

TEST_CASE("footage synthesis: frames are compositions of several times, not copies") {
  const auto footage = travelling_waves(80);
  const auto frames = draw(footage, {.seed = 3}, 40);
  const cv::Rect moving(0, 4, kSize.width, 40);
  for (const auto& frame : frames) {
    double nearest = 1e9;
    for (const auto& source : footage)
      nearest = std::min(nearest, cv::norm(frame(moving), source(moving), cv::NORM_L1) / moving.area());
    CHECK(nearest > 2);
  }
}

TEST_CASE("footage synthesis: speed and direction are those asked for") {
  const auto footage = travelling_waves(80);
  CHECK(mean_step(draw(footage, {.seed = 1, .speed = 0.5}, 60)) == Approx(0.75).margin(0.1));
  CHECK(mean_step(draw(footage, {.seed = 1, .speed = 2}, 60)) == Approx(3).margin(0.2));
  CHECK(mean_step(draw(footage, {.seed = 1, .speed = -1}, 60)) == Approx(-1.5).margin(0.1));
}

TEST_CASE("footage synthesis: a loop repeats itself to the byte") {
  const auto footage = travelling_waves(60);
  const auto frames = draw(footage, {.seed = 2, .speed = GENERATE(1.0, -1.0), .loop = 40}, 80);
  CHECK(same_frames({frames.begin(), frames.begin() + 40}, {frames.begin() + 40, frames.end()}));
  // The last frame leads to the first one as each to the next.
  const auto at = [&](std::size_t t) { return step(frames[t - 1], frames[t], 24); };
  CHECK(std::abs(at(40) - (at(39) + at(41)) / 2) < 0.3);
}

TEST_CASE("footage synthesis: a loop of whole periods of the footage is the footage itself") {
  const auto footage = travelling_waves(80);  // a period has 16 frames
  for (const int loop : {16, 48, 112}) {
    const auto frames = draw(footage, {.seed = 3, .loop = loop}, loop + 1);
    const auto first = std::ranges::find_if(
        footage, [&](const cv::Mat& frame) { return cv::norm(frame, frames[0], cv::NORM_INF) == 0; });
    REQUIRE(first != footage.end());
    const auto phase = static_cast<std::size_t>(first - footage.begin());
    for (std::size_t t = 0; t < frames.size(); ++t)
      CHECK(cv::norm(frames[t], footage[(phase + t) % 16], cv::NORM_INF) <= 1);  // rounding
  }
}

TEST_CASE("footage synthesis: the same bytes at any number of threads and of calls, others of another seed") {
  const auto footage = travelling_waves(40);
  const auto all = draw(footage, {.seed = 7}, 40);
  {
    const core::ThreadLimit limit(1);
    FootageSynthesis synthesis(footage, {.seed = 7});
    auto some = draw(synthesis, 7);
    for (auto& frame : draw(synthesis, 33)) some.push_back(frame);
    CHECK(same_frames(all, some));
  }
  CHECK_FALSE(same_frames(all, draw(footage, {.seed = 8}, 40)));
}

TEST_CASE("footage synthesis: what motion does not explain is not stretched, but played side by side") {
  std::vector<cv::Mat> noise;
  core::Rng rng(2);
  for (int t = 0; t < 30; ++t) {
    cv::Mat1b frame(kSize);
    for (auto& level : frame) level = static_cast<std::uint8_t>(rng.below(256));
    noise.push_back(frame);
  }
  FootageSynthesis synthesis(noise, {.seed = 1});
  CHECK(synthesis.amplitude() == 0);
  CHECK(synthesis.plays() == 3);
  const auto frames = draw(synthesis, 30);
  CHECK(synthesis.copied_share() > 0.3);
  CHECK(synthesis.copied_share() < 0.6);
  for (const auto& frame : frames) {
    // Three frames of the clip have nearly all pixels.
    std::vector<double> shares;
    for (const auto& one : noise) shares.push_back(cv::countNonZero(frame == one) / double(frame.total()));
    std::ranges::sort(shares, std::greater());
    CHECK(shares[0] + shares[1] + shares[2] > 0.85);
    CHECK(shares[3] < 0.05);
  }
}

TEST_CASE("footage synthesis: a loop of plays side by side repeats itself to the byte") {
  std::vector<cv::Mat> noise;
  core::Rng rng(5);
  for (int t = 0; t < 40; ++t) {
    cv::Mat1b frame(kSize);
    for (auto& level : frame) level = static_cast<std::uint8_t>(rng.below(256));
    noise.push_back(frame);
  }
  FootageSynthesis synthesis(noise, {.seed = 2, .loop = 24});
  REQUIRE(synthesis.plays() == 3);
  const auto frames = draw(synthesis, 72);
  CHECK(same_frames({frames.begin(), frames.begin() + 24}, {frames.begin() + 24, frames.begin() + 48}));
  CHECK(same_frames({frames.begin(), frames.begin() + 24}, {frames.begin() + 48, frames.end()}));
}

TEST_CASE("footage synthesis: short and still footages give clips, too") {
  const int count = GENERATE(2, 3, 6);
  const auto frames = draw(travelling_waves(count), {.seed = 1}, 25);
  CHECK(frames.size() == 25);
  const std::vector<cv::Mat> still(static_cast<std::size_t>(count), cv::Mat1b(9, 11, std::uint8_t{40}));
  for (const auto& frame : draw(still, {.seed = 1}, 12)) CHECK(cv::norm(frame, still[0], cv::NORM_INF) == 0);
}

TEST_CASE("footage synthesis: options out of range are refused, and a stop stops it") {
  const auto footage = travelling_waves(10);
  CHECK(message_of<core::InputError>([&] { FootageSynthesis(footage, {.speed = 0}); }) ==
        "FootageSynthesisOptions.speed is 0.000000; allowed is -100 to 100, but not 0");
  CHECK_THROWS_AS(FootageSynthesis(footage, {.loop = 1}), core::InputError);
  CHECK_THROWS_AS(FootageSynthesis({footage.front()}, {}), core::InputError);
  std::stop_source stop;
  FootageSynthesis synthesis(footage, {});
  stop.request_stop();
  CHECK_THROWS_AS(synthesis.each(
                      3, [](const cv::Mat&) {}, core::Context(stop.get_token())),
                  core::Cancelled);
}
