// SPDX-License-Identifier: Apache-2.0
#include "pipeline/output/opacity.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/io/linear_light.hpp"
#include "core/rng.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;
using pipeline::Ground;
using pipeline::Light;

namespace {

const cv::Size kFrame(40, 30);

}  // namespace

TEST_CASE("opacity: over black it is the greatest channel, over white what the least one lacks") {
  const cv::Mat frame = noise_frame(kFrame, CV_8UC3, 1);
  const cv::Mat on_black = with_opacity(frame, {cv::Mat(kFrame, CV_8U, cv::Scalar(0))}, Light::display);
  const cv::Mat on_white = with_opacity(frame, {cv::Mat(kFrame, CV_8U, cv::Scalar(255))}, Light::display);
  for (int y = 0; y < kFrame.height; ++y)
    for (int x = 0; x < kFrame.width; ++x) {
      const auto& level = frame.at<cv::Vec3b>(y, x);
      CHECK(on_black.at<cv::Vec4b>(y, x)[3] == std::max({level[0], level[1], level[2]}));
      CHECK(on_white.at<cv::Vec4b>(y, x)[3] == 255 - std::min({level[0], level[1], level[2]}));
    }
}

TEST_CASE("opacity: over its ground a picture gives the frame again, but for the tolerance") {
  const int tolerance = GENERATE(0, 5), channels = GENERATE(1, 3);
  const cv::Mat ground = noise_frame(kFrame, CV_8UC(channels), 2);
  cv::Mat frame = noise_frame(kFrame, CV_8UC(channels), 3);
  ground.rowRange(0, 10).copyTo(frame.rowRange(0, 10));
  const cv::Mat shown = with_opacity(frame, {ground, tolerance}, Light::display),
                lit = with_opacity(frame, {ground, tolerance}, Light::linear);
  REQUIRE(shown.type() == CV_8UC4);
  REQUIRE(lit.type() == CV_32FC4);
  double worst = 0, worst_light = 0;
  for (int y = 0; y < kFrame.height; ++y)
    for (int x = 0; x < kFrame.width; ++x)
      for (int c = 0; c < 3; ++c) {
        const int k = c % channels;
        const double below = ground.ptr<std::uint8_t>(y)[x * channels + k];
        const double level = frame.ptr<std::uint8_t>(y)[x * channels + k];
        const auto& over = shown.at<cv::Vec4b>(y, x);
        const double opacity = over[3] / 255.0;
        worst = std::max(worst, std::abs(opacity * over[c] + (1 - opacity) * below - level));
        const auto& light = lit.at<cv::Vec4f>(y, x);
        CHECK(light[c] >= 0);
        CHECK(double{light[c]} <= double{light[3]} + 1e-6);
        const double sum = double{light[c]} + (1.0 - double{light[3]}) * io::linear_light(below / 255);
        const double nearest =
            level > below ? std::max(below, level - tolerance) : std::min(below, level + tolerance);
        worst_light = std::max(worst_light, std::abs(sum - io::linear_light(nearest / 255)));
        if (y < 10) CHECK(over[3] == 0);
      }
  CHECK(worst <= tolerance + 0.51);
  CHECK(worst_light < 1e-6);
}

TEST_CASE("opacity: the still ground is what most frames show, and its noise is tolerated") {
  std::vector<cv::Mat> footage;
  core::Rng rng(5);
  for (int t = 0; t < 80; ++t) {
    cv::Mat1b frame(kFrame);
    for (auto& level : frame) level = cv::saturate_cast<std::uint8_t>(100 + 1.5 * rng.normal());
    frame(cv::Rect(t % 30, 8, 10, 10)).setTo(220);
    footage.push_back(frame);
  }
  const Ground ground = pipeline::still_ground(footage);
  for (const auto level : cv::Mat1b(ground.levels))
    CHECK(std::abs(level - 100) <= 2);  // the square is there a third of the time
  CHECK(ground.tolerance >= 4);
  CHECK(ground.tolerance <= 8);
  const cv::Mat shown = with_opacity(footage[7], ground, Light::display);
  int clear = 0, seen = 0;
  for (int y = 0; y < kFrame.height; ++y)
    for (int x = 0; x < kFrame.width; ++x) {
      const int opacity = shown.at<cv::Vec4b>(y, x)[3];
      const bool inside = cv::Rect(7, 8, 10, 10).contains({x, y});
      if (inside && opacity > 100) ++seen;
      if (!inside && opacity == 0) ++clear;
    }
  CHECK(seen == 100);
  CHECK(clear > 0.97 * (kFrame.area() - 100));
  CHECK(contains(message_of<core::InputError>(
                     [&] { const auto ignored = with_opacity(cv::Mat1b(9, 9), ground, Light::display); }),
                 "9x9"));
  CHECK_THROWS_AS(pipeline::still_ground({}), core::InputError);
}
