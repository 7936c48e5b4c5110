// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/seams.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using pipeline::SeamLines;
using pipeline::Seams;

namespace {

/// Noise of 160×80 px that is the same in all frames within a band about a slanted line from top to bottom.
std::vector<cv::Mat> noise_but_for_a_slanted_band(int frames) {
  core::Rng rng(3);
  const cv::Size size(160, 80);
  cv::Mat1b same(size);
  for (auto& level : same) level = static_cast<std::uint8_t>(rng.below(200));
  std::vector<cv::Mat> clip;
  for (int t = 0; t < frames; ++t) {
    cv::Mat1b frame(size);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const bool band = std::abs(x - (68 + 0.3 * y)) < 5;
        const auto level = static_cast<std::uint8_t>(rng.below(200));
        frame(y, x) = band ? same(y, x) : level;
      }
    clip.push_back(frame);
  }
  return clip;
}

cv::Mat1b everywhere(const std::vector<cv::Mat>& clip) {
  return cv::Mat1b(clip.front().size(), 255);
}

}  // namespace

TEST_CASE("seams: they run where both plays look alike") {
  const auto clip = noise_but_for_a_slanted_band(6);
  const Seams seams(clip, everywhere(clip), 2);
  CHECK(seams.plays() == 2);
  const auto lines = seams.next({{0, 3}}, {});
  REQUIRE(lines.size() == 1);
  REQUIRE(lines[0].size() == 40);  // cells of 2 px
  for (std::size_t i = 0; i < lines[0].size(); ++i) {
    const double y = 2 * double(i) + 1, x = 2 * double{lines[0][i]} + 1;
    CHECK(std::abs(x - (68 + 0.3 * y)) < 5);
  }
  CHECK(seams.visibility(0, 0, 3) < 1.5);
  CHECK(seams.visibility(0, 2, 2) == 0);
}

TEST_CASE("seams: each play fills its part of the joined frame, and each pixel lies between both") {
  auto clip = noise_but_for_a_slanted_band(6);
  const bool higher = GENERATE(false, true);
  if (higher)
    for (auto& frame : clip) frame = cv::Mat(frame.t());
  const Seams seams(clip, everywhere(clip), 3);
  const auto lines = seams.next({{0, 3, 5}, {1, 4, 0}}, {});
  const cv::Mat joined = seams.join({clip[0], clip[3], clip[5]}, lines);
  int of[3] = {0, 0, 0};
  for (int y = 0; y < joined.rows; ++y)
    for (int x = 0; x < joined.cols; ++x) {
      const int level = joined.at<std::uint8_t>(y, x);
      int low = 255, high = 0, k = 0;
      for (const int t : {0, 3, 5}) {
        const int own = clip[static_cast<std::size_t>(t)].at<std::uint8_t>(y, x);
        low = std::min(low, own);
        high = std::max(high, own);
        of[k++] += own == level ? 1 : 0;
      }
      CHECK(level >= low);
      CHECK(level <= high);
    }
  const int all = joined.rows * joined.cols;
  for (const int count : of) {
    CHECK(count > all / 10);
    CHECK(count < all * 2 / 3);
  }
}

TEST_CASE("seams: a seam stays where it was unless it pays to leave") {
  const auto clip = noise_but_for_a_slanted_band(6);
  const Seams seams(clip, everywhere(clip), 2);
  const auto line = seams.next({{0, 3}}, {});
  CHECK(seams.next({{1, 4}}, line) == seams.next({{1, 4}}, seams.next({{1, 4}}, line)));
  // What changes sides counts: from a line aside the way is shorter than to the best one at once.
  SeamLines aside = line;
  for (auto& cell : aside[0]) cell = std::max(30.F, cell - 6);
  const auto next = seams.next({{1, 4}}, aside), best = seams.next({{1, 4}}, {});
  double moved = 0, away = 0;
  for (std::size_t i = 0; i < next[0].size(); ++i) {
    moved += std::abs(double{next[0][i]} - double{aside[0][i]});
    away += std::abs(double{best[0][i]} - double{aside[0][i]});
  }
  CHECK(moved < away);
}
