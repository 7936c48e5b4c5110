// SPDX-License-Identifier: Apache-2.0
#include "pipeline/carried/carried_pixels.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>

#include <opencv2/core.hpp>

#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using pipeline::CarriedStroke;

namespace {

std::vector<cv::Mat> noisy_frames(int channels) {
  std::vector<cv::Mat> frames;
  core::Rng rng(2);
  for (int t = 0; t < 2; ++t) {
    cv::Mat frame(50, 60, CV_8UC(channels));
    for (int y = 0; y < frame.rows; ++y)
      for (int x = 0; x < frame.cols * channels; ++x)
        frame.ptr<std::uint8_t>(y)[x] = static_cast<std::uint8_t>(rng.below(256));
    frames.push_back(frame);
  }
  return frames;
}

bool same(const cv::Mat& a, cv::Point p, const cv::Mat& b, cv::Point q) {
  return cv::norm(a(cv::Rect(p, cv::Size(1, 1))), b(cv::Rect(q, cv::Size(1, 1))), cv::NORM_L1) == 0;
}

}  // namespace

TEST_CASE("carried pixels: about a patch lie those about where it was seen, far away nothing changes") {
  const int channels = GENERATE(1, 3);
  const auto footage = noisy_frames(channels);
  cv::Mat frame = footage[0].clone();
  CarriedStroke stroke{1, 1, 0, 6, {}};
  for (int i = 0; i < 3; ++i) stroke.patches.push_back({{25.0 + 4 * i, 20}, {20.0 + 4 * i, 31}, 0, 0, 4});
  pipeline::draw_carried(frame, footage, stroke);
  for (int y = 0; y < frame.rows; ++y)
    for (int x = 0; x < frame.cols; ++x) {
      INFO(x << ' ' << y);
      double least = 1e9;
      for (const auto& patch : stroke.patches)
        least = std::min(least, std::hypot(x - patch.to.x, y - patch.to.y));
      if (least <= 4) CHECK(same(frame, {x, y}, footage[1], {x - 5, y + 11}));
      if (least >= 10) CHECK(same(frame, {x, y}, footage[0], {x, y}));
    }
}

TEST_CASE("carried pixels: they turn with their curve") {
  const auto footage = noisy_frames(1);
  cv::Mat frame = footage[0].clone();
  // What ran to the right is shown running down: a quarter turn back from there to where it was seen.
  pipeline::draw_carried(frame, footage, {1, 1, 0, 6, {{{30, 25}, {28, 24}, 0, -std::numbers::pi / 2, 5}}});
  for (const auto& [x, y] : {std::pair{3, 0}, std::pair{0, 3}, std::pair{-2, 1}})
    CHECK(std::abs(int(frame.at<std::uint8_t>(25 + x, 30 - y)) -
                   int(footage[1].at<std::uint8_t>(24 + y, 28 + x))) <= 1);
}

TEST_CASE("carried pixels: half opaque they are the mean, and what lies outside the frame is none") {
  const auto footage = noisy_frames(1);
  cv::Mat frame = footage[0].clone();
  pipeline::draw_carried(frame, footage, {1, 0.5, 0, 6, {{{30, 25}, {30, 25}, 0, 0, 5}}});
  CHECK_THAT(
      double(frame.at<std::uint8_t>(25, 30)),
      Catch::Matchers::WithinAbs(
          (double(footage[0].at<std::uint8_t>(25, 30)) + double(footage[1].at<std::uint8_t>(25, 30))) / 2,
          0.6));
  frame = footage[0].clone();
  for (const double far : {-500.0, -9.0, 1e5})
    pipeline::draw_carried(frame, footage, {1, 1, 0, 6, {{{far, far}, {9, 9}, 0, 0, 2}}});
  pipeline::draw_carried(frame, footage, {1, 1, 0, 6, {}});
  CHECK(cv::norm(frame, footage[0], cv::NORM_L1) == 0);
}

TEST_CASE("carried pixels: fitted, they take the levels beside the stroke and keep what is on it") {
  // A bright line on a level, carried to a ramp across it that is brighter, or darker.
  const double seen = GENERATE(20, 200);
  cv::Mat1b dark(60, 60, static_cast<std::uint8_t>(seen)), ramp(60, 60);
  dark.row(30).setTo(seen + 50);
  for (int y = 0; y < 60; ++y) ramp.row(y).setTo(static_cast<double>(70 + 2 * y));
  cv::Mat frame = ramp.clone();
  CarriedStroke stroke{0, 1, 255, 6, {}};
  for (int i = 0; i < 5; ++i) stroke.patches.push_back({{20.0 + 4 * i, 30}, {18.0 + 4 * i, 30}, 0, 0, 4});
  pipeline::draw_carried(frame, {dark}, stroke);
  for (int y = 22; y <= 38; ++y) {
    INFO(y);
    const double level = 70 + 2.0 * y, scale = seen > level ? (level + 16) / (seen + 16) : 1;
    CHECK(std::abs(frame.at<std::uint8_t>(y, 28) - (level + (y == 30 ? 50 * scale : 0))) <= 2);
  }
  frame = ramp.clone();
  stroke.fit = 30;  // of the levels that are lacking, or too many
  pipeline::draw_carried(frame, {dark}, stroke);
  CHECK(std::abs(frame.at<std::uint8_t>(29, 28) - (seen < 100 ? seen + 30 : seen - 30)) <= 2);
}

TEST_CASE("carried pixels: what covers its ground keeps its colour on another one") {
  // A bright flame before a red glow, carried into the dark: there is dark beside it, and it is not tinted.
  const cv::Vec3b glow(20, 40, 150), flame(150, 230, 255), dark(8, 8, 10);
  cv::Mat3b seen(60, 60, glow), frame(60, 60, dark);
  for (int y = 28; y <= 32; ++y) seen.row(y).setTo(flame);
  CarriedStroke stroke{0, 1, 255, 6, {}};
  for (int i = 0; i < 5; ++i) stroke.patches.push_back({{20.0 + 4 * i, 30}, {20.0 + 4 * i, 30}, 0, 0, 4});
  for (const bool hides : {false, true}) {
    stroke.hides = hides;
    cv::Mat drawn = frame.clone();
    pipeline::draw_carried(drawn, {seen}, stroke);
    CHECK(cv::norm(drawn.at<cv::Vec3b>(25, 28), dark, cv::NORM_INF) <= 2);
    // what hides is ground, and all of it is fitted
    CHECK((cv::norm(drawn.at<cv::Vec3b>(30, 28), flame, cv::NORM_INF) <= 2) == !hides);
  }
}

TEST_CASE("carried pixels: fitted in part, a ground has a colour between the two") {
  const cv::Vec3b white(250, 250, 250), orange(50, 150, 240);
  cv::Mat frame = cv::Mat3b(60, 60, orange);
  CarriedStroke stroke{0, 1, 100, 6, {}};  // half of the largest difference
  for (int i = 0; i < 5; ++i) stroke.patches.push_back({{20.0 + 4 * i, 30}, {20.0 + 4 * i, 30}, 0, 0, 4});
  pipeline::draw_carried(frame, {cv::Mat3b(60, 60, white)}, stroke);
  CHECK(cv::norm(frame.at<cv::Vec3b>(30, 28), cv::Vec3b(150, 200, 245), cv::NORM_INF) <= 1);
}
