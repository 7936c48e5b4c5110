// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/play_order.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <set>
#include <vector>

#include <opencv2/core.hpp>

#include "core/context.hpp"
#include "pipeline/footage/like_moments.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using pipeline::PlayOrder;

namespace {

/// A bar that swings about the middle, `period` frames a swing.
std::vector<cv::Mat> swing(int frames, double period) {
  std::vector<cv::Mat> clip;
  for (int t = 0; t < frames; ++t) {
    cv::Mat1b frame(40, 64);
    const double middle = 32 + 12 * std::sin(2 * std::numbers::pi * t / period);
    for (int y = 0; y < frame.rows; ++y)
      for (int x = 0; x < frame.cols; ++x)
        frame(y, x) = cv::saturate_cast<std::uint8_t>(20 + 200 * std::exp(-std::pow(x - middle, 2) / 18));
    clip.push_back(frame);
  }
  return clip;
}

}  // namespace

TEST_CASE("play order: the best jumps of a swing lead whole swings on or back") {
  const auto moments = pipeline::compare_moments(swing(100, 25), {});
  CHECK(moments.half == 4);
  for (const int a : {20, 40, 70}) {
    const cv::Mat1f row = moments.cost.row(a);
    const auto best = std::ranges::min_element(row) - row.begin();
    CHECK((best - a - 1) % 25 == 0);
    CHECK(best != a + 1);
  }
  // A place that is passed in the other direction is as like, but moves the other way.
  const int mirrored = 12;  // sin(2π 0/25) = sin(2π 12.5/25)
  CHECK(moments.cost(24, mirrored) > 10 * moments.cost(24, 50));
}

TEST_CASE("play order: it runs on frame by frame, and jumps where moments are alike") {
  const auto moments = pipeline::compare_moments(swing(100, 25), {});
  PlayOrder order(moments, {.seed = 3});
  int jumps = 0;
  std::set<int> shown;
  for (std::int64_t n = 0; n < 2000; ++n) {
    const int a = order.at(n).frame, b = order.at(n + 1).frame;
    REQUIRE(a >= 0);
    REQUIRE(b < 100);
    shown.insert(a);
    if (b == a + 1) continue;
    ++jumps;
    CHECK((b - a - 1) % 25 == 0);
  }
  CHECK(jumps >= 2000 / 100);
  CHECK(jumps <= 2000 / 20);
  CHECK(shown.size() > 85);
  CHECK(order.relative_cost() < 0.1);
}

TEST_CASE("play order: equal seeds play equal orders, asked for in any order, and others another one") {
  const auto moments = pipeline::compare_moments(swing(60, 25), {});
  PlayOrder forwards(moments, {.seed = 5}), backwards(moments, {.seed = 5}), other(moments, {.seed = 6});
  std::vector<pipeline::PlayedMoment> a, b, c;
  for (int n = 0; n < 300; ++n) a.push_back(forwards.at(n));
  for (int n = 299; n >= 0; --n) b.push_back(backwards.at(n));
  std::ranges::reverse(b);
  for (int n = 0; n < 300; ++n) c.push_back(other.at(n));
  CHECK(a == b);
  CHECK(a != c);
}

TEST_CASE("play order: a turn goes on with both runs and keeps inside the footage") {
  const int frames = GENERATE(2, 3, 5, 8, 13, 30, 80);
  std::vector<cv::Mat> flicker;  // moments are alike, none is the same
  for (int t = 0; t < frames; ++t)
    flicker.push_back(cv::Mat1b(16, 16, static_cast<std::uint8_t>(100 + 40 * (t % 2) + t % 7)));
  PlayOrder order(pipeline::compare_moments(flicker, {}));
  for (std::int64_t n = 0; n < 600; ++n) {
    const auto moment = order.at(n);
    REQUIRE(moment.frame >= 0);
    REQUIRE(moment.frame < frames);
    REQUIRE(moment.other >= 0);
    REQUIRE(moment.other < frames);
    if (moment.half == 0) continue;
    REQUIRE(moment.place >= -moment.half);
    REQUIRE(moment.place < moment.half);
    const auto next = order.at(n + 1);
    if (moment.place + 1 < moment.half) {
      CHECK(next.frame == moment.frame + 1);
      CHECK(next.other == moment.other + 1);
    } else {
      CHECK((next.frame == moment.other + 1 || frames < 30));  // short ones are left at once
    }
  }
}

TEST_CASE("play order: a footage that is never the same again is played to its end and back") {
  const int frames = GENERATE(30, 80);
  std::vector<cv::Mat> drift;
  for (int t = 0; t < frames; ++t) drift.push_back(cv::Mat1b(16, 16, static_cast<std::uint8_t>(3 * t)));
  const auto moments = pipeline::compare_moments(drift, {});
  PlayOrder order(moments, {.seed = 4});
  std::vector<int> shown(static_cast<std::size_t>(frames));
  for (std::int64_t n = 0; n < 40 * frames; ++n) {
    const auto moment = order.at(n), next = order.at(n + 1);
    CHECK(moment.half == 0);
    CHECK(std::abs(next.frame - moment.frame) == 1);
    ++shown[static_cast<std::size_t>(moment.frame)];
  }
  CHECK(order.plays_back());
  CHECK(order.relative_cost() == 0);
  // All but the first and the last frame are passed twice on each way to and fro.
  for (int t = 2; t + 2 < frames; ++t) CHECK(std::abs(shown[static_cast<std::size_t>(t)] - 40) <= 2);

  const int length = GENERATE(6, 7);
  PlayOrder loop(moments, {.seed = 4, .loop = length});
  for (std::int64_t n = 0; n < 2 * length; ++n) {
    CHECK(loop.at(n) == loop.at(n + length));
    CHECK(std::abs(loop.at(n + 1).frame - loop.at(n).frame) <= 1);
  }
}

TEST_CASE("play order: beside another play it goes where both fit, and never where they must not") {
  const auto moments = pipeline::compare_moments(swing(100, 25), {});
  PlayOrder one(moments, {.seed = 1});
  // Only halves of the swing that differ may be shown at once.
  const auto fits = [&](std::int64_t n, int frame) {
    const int apart = ((one.at(n).frame - frame) % 25 + 25) % 25;
    return apart >= 10 && apart <= 15 ? 0.1 : std::numeric_limits<double>::infinity();
  };
  PlayOrder other(moments, {.seed = 2, .beside = fits});
  int fitting = 0;
  for (std::int64_t n = 0; n < 500; ++n) fitting += std::isfinite(fits(n, other.at(n).frame)) ? 1 : 0;
  CHECK(fitting > 480);
}

TEST_CASE("play order: a loop comes back to its first frame by a jump like the others") {
  const auto moments = pipeline::compare_moments(swing(100, 25), {});
  const int length = GENERATE(2, 50, 75, 92, 150, 333);
  PlayOrder order(moments, {.seed = 2, .loop = length});
  for (std::int64_t n = 0; n < length; ++n) CHECK(order.at(n) == order.at(n + length));
  if (length % 25 == 0 && length < 92) {
    CHECK(order.at(0).frame == order.at(length - 1).frame + 1 - length);
    CHECK(order.relative_cost() < 0.1);
  }
}
