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
  CarriedStroke stroke{1, 1, 6, {}};
  for (int i = 0; i < 3; ++i) stroke.patches.push_back({{25.0 + 4 * i, 20}, {20.0 + 4 * i, 31}, 0, 4});
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
  pipeline::draw_carried(frame, footage, {1, 1, 6, {{{30, 25}, {28, 24}, -std::numbers::pi / 2, 5}}});
  for (const auto& [x, y] : {std::pair{3, 0}, std::pair{0, 3}, std::pair{-2, 1}})
    CHECK(std::abs(int(frame.at<std::uint8_t>(25 + x, 30 - y)) -
                   int(footage[1].at<std::uint8_t>(24 + y, 28 + x))) <= 1);
}

TEST_CASE("carried pixels: half opaque they are the mean, and what lies outside the frame is none") {
  const auto footage = noisy_frames(1);
  cv::Mat frame = footage[0].clone();
  pipeline::draw_carried(frame, footage, {1, 0.5, 6, {{{30, 25}, {30, 25}, 0, 5}}});
  CHECK_THAT(
      double(frame.at<std::uint8_t>(25, 30)),
      Catch::Matchers::WithinAbs(
          (double(footage[0].at<std::uint8_t>(25, 30)) + double(footage[1].at<std::uint8_t>(25, 30))) / 2,
          0.6));
  frame = footage[0].clone();
  for (const double far : {-500.0, -9.0, 1e5})
    pipeline::draw_carried(frame, footage, {1, 1, 6, {{{far, far}, {9, 9}, 0, 2}}});
  pipeline::draw_carried(frame, footage, {1, 1, 6, {}});
  CHECK(cv::norm(frame, footage[0], cv::NORM_L1) == 0);
}
