// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/between_frames.hpp"

#include <cstdint>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "pipeline/footage/motion_scale.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using pipeline::MovingFrame;

namespace {

/// A ramp that moves by 8 px a frame along x and 4 px along y: its levels fall by 1 a px there.
cv::Mat moved_ramp(int t, int channels) {
  cv::Mat picture(60, 90, CV_8UC(channels));
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x)
      for (int c = 0; c < channels; ++c)
        picture.ptr<std::uint8_t>(y)[channels * x + c] =
            static_cast<std::uint8_t>(100 + (x - 8 * t) + (y - 4 * t) - 5 * c);
  return picture;
}

}  // namespace

TEST_CASE(
    "between frames: what moves is where it has got to, forwards from one and backwards from the next") {
  for (const int channels : {1, 3}) {
    const cv::Mat motion(15, 30, CV_32FC2, cv::Scalar(8, 4));
    std::vector<cv::Mat> pictures;
    std::vector<MovingFrame> frames;
    for (int t = 0; t < 3; ++t) pictures.push_back(moved_ramp(t, channels));
    for (const auto& picture : pictures) frames.push_back({&picture, &motion});
    for (const double time : {0.0, 0.25, 0.4, 0.5, 0.6, 0.75, 1.0, 1.25, 1.75}) {
      const auto drawn = pipeline::draw_between(frames, time, cv::Mat1f(60, 90, 0.F));
      for (int y = 20; y < 40; y += 3)
        for (int x = 25; x < 65; x += 4)
          for (int c = 0; c < channels; ++c)
            CHECK_THAT(static_cast<double>(drawn.ptr<std::uint8_t>(y)[channels * x + c]),
                       test::WithinAbs(100 + x + y - 12 * time - 5 * c, 0.51));
    }
  }
}

TEST_CASE("between frames: motion is read at the pixels' middles, and every pixel has its own time") {
  // The left half rests, the right one moves by 10 px; one vector for 2 × 2 pixels.
  cv::Mat2f motion(20, 30, cv::Vec2f(0, 0));
  motion.colRange(15, 30).setTo(cv::Vec2f(10, 0));
  cv::Mat1b stripes(40, 60);
  for (int y = 0; y < stripes.rows; ++y)
    for (int x = 0; x < stripes.cols; ++x) stripes(y, x) = static_cast<std::uint8_t>(4 * x);
  const cv::Mat motion_field = motion, picture = stripes;
  const std::vector<MovingFrame> frames(2, {&picture, &motion_field});
  cv::Mat1f offsets(40, 60, 0.F);
  offsets.rowRange(20, 40).setTo(0.3F);
  const cv::Mat1b drawn = pipeline::draw_between(frames, 0, offsets);
  CHECK(cv::countNonZero(drawn.rowRange(0, 20) != stripes.rowRange(0, 20)) == 0);
  CHECK(cv::countNonZero(drawn(cv::Rect(0, 20, 29, 20)) != stripes(cv::Rect(0, 20, 29, 20))) == 0);
  // Vectors stand at 28.5 (0) and 30.5 (10): between them motion grows by 5 px a pixel.
  for (const auto& [x, moved] : {std::pair(29, 2.5), {30, 7.5}, {31, 10.0}, {45, 10.0}})
    CHECK_THAT(static_cast<double>(drawn(30, x)), test::WithinAbs(4 * (x - 0.3 * moved), 0.51));
}

TEST_CASE("motion scale: pixels move whose levels have an SD above 6 over time") {
  std::vector<cv::Mat> footage;
  for (int t = 0; t < 40; ++t) {
    cv::Mat3b picture(4, 6, cv::Vec3b(100, 100, 100));
    const int sign = t % 2 == 0 ? 1 : -1;
    const auto level = [&](int sd) { return static_cast<std::uint8_t>(100 + sign * sd); };
    picture(1, 1) = {level(5), level(5), level(5)};
    picture(1, 2) = {level(7), level(7), level(7)};
    picture(2, 3) = {100, level(12), 100};  // its mean variance is 48
    picture(3, 5) = {100, level(9), 100};   // 27
    footage.push_back(picture);
  }
  const auto moves = pipeline::moving_pixels(footage);
  CHECK(cv::countNonZero(moves) == 2);
  CHECK(moves(1, 2) == 255);
  CHECK(moves(2, 3) == 255);
}
