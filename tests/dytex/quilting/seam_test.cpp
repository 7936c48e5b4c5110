// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/seam.hpp"

#include <cstdlib>
#include <functional>
#include <limits>
#include <vector>

#include <opencv2/core.hpp>

#include "core/rng.hpp"
#include "dytex/quilting/blocks.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::dytex::detail;

namespace {

cv::Mat random_cost(int rows, int columns, std::uint64_t seed, std::uint32_t levels) {
  cv::Mat cost(rows, columns, CV_64F);
  core::Rng rng(seed);
  for (double& value : cv::Mat_<double>(cost)) value = rng.below(levels);
  return cost;
}

// The least cost of all monotone paths, one after the other.
double least_by_enumeration(const cv::Mat& cost) {
  double least = std::numeric_limits<double>::max();
  const std::function<void(int, int, double)> go = [&](int y, int x, double sum) {
    if (x < 0 || x >= cost.cols) return;
    sum += cost.at<double>(y, x);
    if (y + 1 == cost.rows) {
      least = std::min(least, sum);
      return;
    }
    for (int step = -1; step <= 1; ++step) go(y + 1, x + step, sum);
  };
  for (int x = 0; x < cost.cols; ++x) go(0, x, 0);
  return least;
}

}  // namespace

TEST_CASE("a seam costs the least of all monotone paths") {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const int columns = 1 + static_cast<int>(seed % 6), rows = 1 + static_cast<int>(seed % 8);
    const cv::Mat cost = random_cost(rows, columns, seed, seed % 2 == 0 ? 3 : 1000);
    const auto seam = least_seam(cost);
    REQUIRE(static_cast<int>(seam.size()) == rows);
    for (std::size_t y = 0; y < seam.size(); ++y) {
      CHECK((seam[y] >= 0 && seam[y] < columns));
      if (y > 0) CHECK(std::abs(seam[y] - seam[y - 1]) <= 1);
    }
    CHECK(seam_cost(cost, seam) == least_by_enumeration(cost));
  }
}

TEST_CASE("a block shows on its side of all its seams and nowhere else") {
  const cv::Mat error = random_cost(12, 14, 3, 100);
  const QuiltBlock block{1, 1, {0, 0, 14, 12}, 4, 3, 5, 2};
  const cv::Mat mask = block_mask(error, block);
  cv::Mat mirrored, turned;
  cv::flip(error, mirrored, 1);
  const auto left = least_seam(error.colRange(0, 4)), right = least_seam(mirrored.colRange(0, 5));
  const auto top = least_seam(cv::Mat(error.t()).colRange(0, 3));
  cv::flip(cv::Mat(error.t()), turned, 1);
  const auto bottom = least_seam(turned.colRange(0, 2));
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 14; ++x) {
      const auto u = static_cast<std::size_t>(x), v = static_cast<std::size_t>(y);
      const bool own = x >= left[v] && 13 - x >= right[v] && y >= top[u] && 11 - y >= bottom[u];
      CHECK((mask.at<unsigned char>(y, x) == 255) == own);
    }
}

TEST_CASE("blocks cover the canvas and each lies on what its waves before have filled") {
  const bool torus = GENERATE(false, true);
  const cv::Size size(83, 57);
  const auto plan = plan_blocks(size, {20, 16}, 5, torus);
  cv::Mat filled = cv::Mat::zeros(plan.canvas, CV_32S);
  const auto at = [&](int x, int y) -> int& {
    return filled.at<int>(y % plan.canvas.height, x % plan.canvas.width);
  };
  CHECK(plan.canvas.width >= size.width);
  CHECK(plan.canvas.height >= size.height);
  if (torus) CHECK(plan.canvas == size);
  for (const auto& wave : plan.waves) {
    for (const auto& block : wave) {
      CHECK(block.place.width <= 20);
      CHECK(block.place.height <= 16);
      int overlap = 0;
      for (int y = 0; y < block.place.height; ++y)
        for (int x = 0; x < block.place.width; ++x)
          overlap += at(block.place.x + x, block.place.y + y) > 0 ? 1 : 0;
      CHECK(overlap == count_pixels(overlap_runs(block)));
      int boxed = 0;
      for (const auto& box : run_boxes(overlap_runs(block))) boxed += box.area();
      CHECK(boxed == overlap);
    }
    for (const auto& block : wave)
      for (int y = 0; y < block.place.height; ++y)
        for (int x = 0; x < block.place.width; ++x) ++at(block.place.x + x, block.place.y + y);
  }
  CHECK(cv::countNonZero(filled) == plan.canvas.area());
}
