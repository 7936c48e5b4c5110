// SPDX-License-Identifier: Apache-2.0
#include "core/math/image_gradient.hpp"

#include <algorithm>

#include <opencv2/core.hpp>

#include "core/math/bilinear.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

cv::Mat1f plane(int rows, int cols, float across, float down) {
  cv::Mat1f levels(rows, cols);
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < cols; ++x)
      levels(y, x) = 5 + across * static_cast<float>(x) + down * static_cast<float>(y);
  return levels;
}

}  // namespace

TEST_CASE("The gradient of a plane is its slope, along either axis") {
  const auto gradient = core::sobel(plane(9, 12, 3, -4));
  for (int y = 1; y < 8; ++y)
    for (int x = 1; x < 11; ++x) {
      CHECK_THAT(double{gradient.x.at<float>(y, x)}, WithinAbs(3, 1e-4));
      CHECK_THAT(double{gradient.y.at<float>(y, x)}, WithinAbs(-4, 1e-4));
      CHECK_THAT(double{gradient.size.at<float>(y, x)}, WithinAbs(5, 1e-4));
    }
}

TEST_CASE("Between pixels a plane is itself, beyond the frame its border") {
  const auto levels = plane(4, 6, 3, -4);
  for (double y = -2; y <= 6; y += 0.3)
    for (double x = -2; x <= 8; x += 0.3) {
      const double u = std::clamp(x, 0.0, 5.0), v = std::clamp(y, 0.0, 3.0);
      CHECK_THAT(core::sample_bilinear(levels, x, y), WithinAbs(5 + 3 * u - 4 * v, 1e-4));
    }
}
