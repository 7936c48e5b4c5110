// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/time_front.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "tests/support/catch.hpp"

using namespace emberfold;

TEST_CASE("time front: offsets run evenly between the places where waves are summed, along x and y") {
  const pipeline::TimeFront front(4, 30, 0.2, 5);
  const cv::Mat1f offsets = front.at(3, {96, 64}, front.bound());
  for (int y = 0; y + 8 < offsets.rows; y += 8)
    for (int x = 0; x + 8 < offsets.cols; x += 8)
      for (int k = 1; k < 8; ++k) {
        const auto between = [&](float a, float b) { return double{a} + k / 8.0 * (double{b} - double{a}); };
        CHECK_THAT(double{offsets(y + k, x)},
                   test::WithinAbs(between(offsets(y, x), offsets(y + 8, x)), 1e-4));
        CHECK_THAT(double{offsets(y, x + k)},
                   test::WithinAbs(between(offsets(y, x), offsets(y, x + 8)), 1e-4));
      }
}

TEST_CASE("time front: offsets have the spread that is asked for, and never more than the most") {
  double squares = 0, count = 0, most = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const pipeline::TimeFront front(2, 60, 0.2, seed);
    for (const int n : {0, 50, 100})
      for (const float offset : front.at(n, {128, 96}, front.bound())) {
        squares += double{offset} * double{offset}, count += 1;
        most = std::max(most, std::abs(double{offset}));
      }
  }
  CHECK_THAT(std::sqrt(squares / count), test::WithinAbs(2, 0.15));
  CHECK(most <= 6);
}
