// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/clearer_channel.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

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
  return pipeline::find_clearer_channel(source, {});
}

}  // namespace

TEST_CASE("clearer channel: things of their ground's brightness, and blue ones on black, have one") {
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

TEST_CASE("clearer channel: none for red or green on black, grey, noise alone and clips without colour") {
  CHECK_FALSE(clearer({5, 5, 200}, {5, 5, 5}));
  CHECK_FALSE(clearer({5, 200, 5}, {5, 5, 5}));
  CHECK_FALSE(clearer({200, 200, 200}, {50, 50, 50}));
  CHECK_FALSE(clearer({90, 90, 90}, {90, 90, 90}));
  core::Clip grey;
  grey.info.width = grey.info.height = 32, grey.info.channels = 1, grey.info.frames = 1;
  grey.frames.emplace_back(32, 32, CV_8U, cv::Scalar(7));
  core::ClipSource source(grey);
  CHECK_FALSE(pipeline::find_clearer_channel(source, {}));
}
