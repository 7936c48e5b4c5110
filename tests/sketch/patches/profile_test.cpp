// SPDX-License-Identifier: Apache-2.0
#include "sketch/patches/profile.hpp"

#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>

#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

constexpr double kLeft = 50, kMiddle = 160, kRight = 90, kWidth = 5, kBlur = 1.2;

double below(double x) {
  return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

/// A line through (40, 40) between sides of unlike levels.
cv::Mat1f line(double theta) {
  cv::Mat1f levels(80, 80);
  for (int y = 0; y < levels.rows; ++y)
    for (int x = 0; x < levels.cols; ++x) {
      const double d = -(x - 40) * std::sin(theta) + (y - 40) * std::cos(theta);  // to the right of the line
      levels(y, x) = static_cast<float>(kLeft + (kMiddle - kLeft) * below((d + kWidth / 2) / kBlur) +
                                        (kRight - kMiddle) * below((d - kWidth / 2) / kBlur));
    }
  return levels;
}

}  // namespace

TEST_CASE("A line's contrast is against the mean of its sides, by what the blur leaves of it") {
  for (const double theta : {0.0, 0.6, 2.3, -1.1}) {
    const auto patch = sketch::fit_patch(line(theta), {40, 40}, theta, sketch::CreaseKind::ridge, 2, 7);
    CAPTURE(theta);
    CHECK_THAT(double{patch.left[0]}, WithinAbs(kLeft, 2));
    CHECK_THAT(double{patch.right[0]}, WithinAbs(kRight, 2));
    CHECK_THAT(double{patch.middle[0]}, WithinAbs(kMiddle, 4));
    CHECK_THAT(patch.width, WithinAbs(kWidth, 0.2));
    CHECK_THAT(patch.blur, WithinAbs(kBlur, 0.15));
    const double seen = 1 - 2 * below(-kWidth / 2 / kBlur);
    CHECK_THAT(patch.contrast, WithinAbs(seen * (kMiddle - (kLeft + kRight) / 2), 4));
  }
}
