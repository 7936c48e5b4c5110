// SPDX-License-Identifier: Apache-2.0
#include "sketch/steadying/carried_sketch.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

/// Motion (0.02 x + 1, −0.03 y) of a frame, one vector for `each` × `each` pixels, told of their middles.
cv::Mat linear_motion(cv::Size frame, int each) {
  cv::Mat2f motion(frame.height / each, frame.width / each);
  for (int y = 0; y < motion.rows; ++y)
    for (int x = 0; x < motion.cols; ++x) {
      const double px = (x + 0.5) * each - 0.5, py = (y + 0.5) * each - 0.5;
      motion(y, x) = {static_cast<float>(0.02 * px + 1), static_cast<float>(-0.03 * py)};
    }
  return motion;
}

}  // namespace

TEST_CASE("Motion is read at its place in the frame, however coarse it is") {
  const cv::Size frame(64, 48);
  for (const int each : {1, 2, 4}) {
    const auto motion = linear_motion(frame, each);
    const double border = 0.5 * (each - 1);
    for (double y = -3; y < 52; y += 3.7)
      for (double x = -3; x < 68; x += 4.3) {
        const double u = std::clamp(x, border, 63 - border), v = std::clamp(y, border, 47 - border);
        const auto found = sketch::sample_motion(motion, frame, {x, y});
        CHECK_THAT(found.x, WithinAbs(0.02 * u + 1, 1e-5));
        CHECK_THAT(found.y, WithinAbs(-0.03 * v, 1e-5));
      }
  }
  graph::Patch patch;
  patch.position = {20, 30};
  const auto carried = sketch::carry_sketch({{{{0}, {}, patch}}, {}}, linear_motion(frame, 4), frame);
  CHECK_THAT(carried.patch(0).position.x, WithinAbs(21.4, 1e-5));
  CHECK_THAT(carried.patch(0).position.y, WithinAbs(29.1, 1e-5));
}

TEST_CASE("A frame differs from another by what its motion does not explain") {
  cv::Mat1f luma(40, 60), other(40, 60);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 60; ++x) {
      luma(y, x) = static_cast<float>(3 * x + y);
      other(y, x) = static_cast<float>(3 * (x - 4) + y);  // moved by 4 px to the right
    }
  const cv::Mat moved(10, 15, CV_32FC2, cv::Scalar(4, 0)), still(10, 15, CV_32FC2, cv::Scalar(0, 0));
  const auto explained = sketch::measure_difference(luma, other, moved);
  const auto plain = sketch::measure_difference(luma, other, still);
  for (int y = 12; y < 28; ++y)
    for (int x = 15; x < 40; ++x) {
      CHECK_THAT(double{explained(y, x)}, WithinAbs(0, 0.02));
      CHECK_THAT(double{plain(y, x)}, WithinAbs(12, 0.02));
    }
}
