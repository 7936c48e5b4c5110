// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/like_moments.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <opencv2/core.hpp>

#include "core/context.hpp"
#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;

TEST_CASE("like moments: a jump costs the mean distance of the frames about both moments") {
  // Flat frames: their distance is that of their levels.
  core::Rng rng(4);
  std::vector<int> levels;
  std::vector<cv::Mat> footage;
  for (int t = 0; t < 40; ++t) {
    levels.push_back(static_cast<int>(rng.below(200)));
    footage.emplace_back(12, 16, CV_8U, cv::Scalar(levels.back()));
  }
  const auto moments = pipeline::compare_moments(footage, {});
  REQUIRE(moments.half == 4);
  const auto distance = [&](int i, int j) {
    return std::abs(levels[static_cast<std::size_t>(i)] - levels[static_cast<std::size_t>(j)]);
  };
  double change = 0;
  for (int t = 0; t + 1 < 40; ++t) change += distance(t, t + 1) / 39.0;
  CHECK_THAT(moments.change, test::WithinAbs(change, 1e-3));
  int jumps = 0;
  for (int a = 4; a < 35; ++a)
    for (int b = 4; b < 36; ++b) {
      if (!std::isfinite(moments.cost(a, b))) continue;
      double sum = 0;
      for (int d = -4; d <= 4; ++d) sum += distance(a + 1 + d, b + d);
      CHECK_THAT(double{moments.cost(a, b)}, test::WithinAbs(sum / 9, 1e-2));
      ++jumps;
    }
  CHECK(jumps > 300);
}
