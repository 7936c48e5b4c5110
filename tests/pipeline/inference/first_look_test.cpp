// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/first_look.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

using Scene = std::function<double(Point, int)>;

std::vector<int> cuts_of(const Scene& level) {
  core::Clip clip;
  clip.info.width = 96, clip.info.height = 72, clip.info.channels = 1, clip.info.frames = 30;
  for (int t = 0; t < 30; ++t) {
    cv::Mat bytes;
    with_noise(draw({96, 72}, [&](Point p) { return level(p, t); }), 2, static_cast<std::uint64_t>(t) + 1)
        .convertTo(bytes, CV_8U);
    clip.frames.push_back(bytes);
  }
  core::ClipSource source(clip);
  return pipeline::look_over(source, {}).cuts;
}

double waves(Point p, double phase) {
  return 120 + 60 * std::sin(p.x / 9 + phase) * std::cos(p.y / 7);
}
double spot(Point p, Point at) {
  return 60 + 120 * reached(12 - distance(p, at), 2);
}

/// Returns what is found for a disc of one colour (blue, green, red) on a ground of another, with noise.
std::optional<pipeline::ClearerChannel> clearer(const cv::Scalar& disc, const cv::Scalar& ground) {
  core::Clip clip;
  clip.info.width = 96, clip.info.height = 72, clip.info.channels = 3, clip.info.frames = 5;
  for (std::uint64_t t = 0; t < 5; ++t) {
    std::vector<cv::Mat> channels;
    for (int c = 0; c < 3; ++c)
      channels.push_back(with_noise(draw({96, 72},
                                         [&](Point p) {
                                           const double in = reached(12 - distance(p, {40., 30.}), 2);
                                           return ground[c] + in * (disc[c] - ground[c]);
                                         }),
                                    0.5, 3 * t + static_cast<std::uint64_t>(c) + 1));
    cv::Mat frame;
    cv::merge(channels, frame);
    frame.convertTo(frame, CV_8U);
    clip.frames.push_back(frame);
  }
  core::ClipSource source(clip);
  return pipeline::look_over(source, {}).clearer;
}

}  // namespace

TEST_CASE("first look: another scene, black frames and a flash begin and end with a cut") {
  CHECK(cuts_of([](Point p, int t) {
          return t < 12 ? waves(p, 0.1 * t) : spot(p, {40, 30});
        }) == std::vector{12});
  CHECK(cuts_of([](Point p, int t) {
          return t >= 10 && t < 15 ? 0 : spot(p, {30. + t, 30});
        }) == std::vector{10, 15});
  CHECK(cuts_of([](Point p, int t) { return t == 20 ? 255 : waves(p, 0.1 * t); }) == std::vector{20, 21});
}

TEST_CASE("first look: things that appear, flickering light, fast motion and noise are no cuts") {
  CHECK(cuts_of([](Point p, int t) { return t < 15 ? 60 : spot(p, {48, 36}); }).empty());
  CHECK(cuts_of([](Point p, int t) { return waves(p, 0.1 * t) * (t % 5 == 2 ? 0.6 : 1); }).empty());
  CHECK(cuts_of([](Point p, int t) { return waves(p, 1.3 * t); }).empty());
  CHECK(cuts_of([](Point, int) { return 100; }).empty());
}

TEST_CASE("first look: events within one frame of a cut have probability 0") {
  std::vector<graph::Event> events(4);
  const std::array frames{8, 9, 11, 12};
  for (std::size_t k = 0; k < 4; ++k) events[k].frame = frames[k], events[k].probability = 0.9;
  pipeline::disbelieve_cuts(events, {10});
  CHECK(events[0].probability == 0.9);
  CHECK(events[1].probability == 0);
  CHECK(events[2].probability == 0);
  CHECK(events[3].probability == 0.9);
}

TEST_CASE(
    "first look: a channel shows more where things have their ground's brightness, or are blue on black") {
  const auto red = clearer({40, 60, 190}, {40, 126, 60});  // both of luma 97
  REQUIRE(red);
  CHECK(red->channel == 0);
  CHECK(red->times > 10);
  const auto green = clearer({40, 126, 60}, {40, 60, 190});
  REQUIRE(green);
  CHECK(green->channel == 0);
  const auto blue = clearer({200, 5, 5}, {5, 5, 5});
  REQUIRE(blue);
  CHECK(blue->channel == 2);
  CHECK(blue->times == Approx(1 / 0.114).epsilon(0.1));
}

TEST_CASE(
    "first look: none shows more of red or green on black, grey, noise alone and clips without colour") {
  CHECK_FALSE(clearer({5, 5, 200}, {5, 5, 5}));
  CHECK_FALSE(clearer({5, 200, 5}, {5, 5, 5}));
  CHECK_FALSE(clearer({200, 200, 200}, {50, 50, 50}));
  CHECK_FALSE(clearer({90, 90, 90}, {90, 90, 90}));
  core::Clip grey;
  grey.info.width = grey.info.height = 32, grey.info.channels = 1, grey.info.frames = 1;
  grey.frames.emplace_back(32, 32, CV_8U, cv::Scalar(7));
  core::ClipSource source(grey);
  CHECK_FALSE(pipeline::look_over(source, {}).clearer);
}
