// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/turn.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;

namespace {

/// Frames of a texture that moves right by 4 px from one to the next; larger than motion is measured at.
cv::Mat moved_right(int px) {
  core::Rng rng(7);
  cv::Mat1f noise(240, 400), smooth;
  for (float& value : noise) value = static_cast<float>(rng.normal());
  cv::GaussianBlur(noise, smooth, {}, 5);
  cv::normalize(smooth, smooth, 20, 230, cv::NORM_MINMAX);
  cv::Mat bytes;
  smooth(cv::Rect(40 - px, 0, 320, 240)).convertTo(bytes, CV_8U);
  return bytes;
}

}  // namespace

TEST_CASE("turn: motion is in pixels of the frame") {
  const cv::Mat motion = pipeline::footage_motion(moved_right(0), moved_right(4));
  REQUIRE(motion.cols < 320);
  std::vector<float> right;  // none where both frames are alike: the upper quarter tells
  for (const auto& v : cv::Mat2f(motion)) right.push_back(v[0]);
  const auto upper = right.begin() + static_cast<std::ptrdiff_t>(right.size() * 3 / 4);
  std::ranges::nth_element(right, upper);
  CHECK_THAT(double{*upper}, test::WithinAbs(4, 0.4));
}

TEST_CASE("turn: a frame between two shows what moves on its way") {
  const cv::Rect inside(40, 40, 240, 160);
  const auto error = [&](const cv::Mat& a, const cv::Mat& b) {
    return cv::norm(a(inside), b(inside)) / std::sqrt(double(inside.area()));
  };
  const cv::Mat a = moved_right(0), b = moved_right(4);
  for (const int px : {1, 2, 3}) {
    const cv::Mat truth = moved_right(px), drawn = pipeline::draw_between(a, b, px / 4.0);
    CHECK(error(drawn, truth) < 0.35 * error(px < 3 ? a : b, truth));
  }
}
