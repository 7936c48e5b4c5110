// SPDX-License-Identifier: Apache-2.0
#include "pipeline/frame_motion.hpp"

#include <algorithm>

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
        const auto found = pipeline::sample_motion(motion, frame, {x, y});
        CHECK_THAT(found.x, WithinAbs(0.02 * u + 1, 1e-5));
        CHECK_THAT(found.y, WithinAbs(-0.03 * v, 1e-5));
      }
  }
}
