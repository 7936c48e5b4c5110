// SPDX-License-Identifier: Apache-2.0
#include "sketch/background/level_range.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

/// Dark left of the column, bright right of it, 100 × 70 px, in blue, green, red.
cv::Mat two_sides(int column) {
  cv::Mat levels(70, 100, CV_32FC3, cv::Scalar(200, 180, 160));
  levels.colRange(0, column).setTo(cv::Scalar(20, 40, 60));
  return levels;
}

graph::AttributeGraph upright(double x, bool step) {
  graph::Patch patch;
  patch.type = step ? graph::PatchType::step : graph::PatchType::ridge;
  patch.position = {x, 35};
  patch.theta = -1.5707963267948966;  // upwards: the right side lies at greater x
  patch.width = step ? 0 : 2, patch.blur = 1;
  patch.left = step ? graph::Level{20, 40, 60} : graph::Level{200, 180, 160};
  patch.right = {200, 180, 160};
  for (std::size_t c = 0; c < 3; ++c)
    patch.middle[c] = step ? (patch.left[c] + patch.right[c]) / 2 : patch.left[c] + 30;
  patch.contrast = step ? 130 : 25;
  return {{{{0}, {}, patch}}, {}};
}

graph::Patch kept(double x, bool step, const sketch::LevelRange& seen) {
  return sketch::clamp_levels(upright(x, step), seen).patch(0);
}

}  // namespace

TEST_CASE("Seen levels: cells have the least and the greatest of all frames") {
  sketch::LevelRange all;
  for (const int column : {40, 48, 56})
    sketch::extend_level_range(all, sketch::measure_level_range(two_sides(column)));
  REQUIRE(all.low.size() == cv::Size(13, 9));
  CHECK(all.low.at<cv::Vec3b>(4, 2) == cv::Vec3b(20, 40, 60));
  CHECK(all.high.at<cv::Vec3b>(4, 2) == cv::Vec3b(20, 40, 60));
  for (const int cell : {5, 6}) {  // from 36 to 51 and from 44 to 59: both sides in one frame or another
    CHECK(all.low.at<cv::Vec3b>(4, cell) == cv::Vec3b(20, 40, 60));
    CHECK(all.high.at<cv::Vec3b>(4, cell) == cv::Vec3b(200, 180, 160));
  }
  CHECK(all.low.at<cv::Vec3b>(8, 12) == cv::Vec3b(200, 180, 160));
}

TEST_CASE("Seen levels: a step keeps what it shows in its place and nothing of it where it was never seen") {
  const auto seen = sketch::measure_level_range(two_sides(48));
  const auto there = kept(48, true, seen);
  CHECK(there == upright(48, true).patch(0));
  const auto away = kept(80, true, seen);
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK(away.left[c] == away.right[c]);
    CHECK(away.middle[c] == away.right[c]);
  }
  CHECK(away.contrast == 0);
  CHECK(kept(80, true, {}) == upright(80, true).patch(0));
}

TEST_CASE("Seen levels: a line takes the levels of its place and keeps its height as far as they allow") {
  const auto flat = kept(12, false, sketch::measure_level_range(two_sides(48)));
  CHECK(flat.left == graph::Level{20, 40, 60});
  CHECK(flat.right == flat.left);
  CHECK(flat.middle == flat.left);
  // The line at its own place: 30 above its sides, of which erf(1/sqrt 2) is visible, where 30, 20 and 5 were
  // seen.
  auto frame = two_sides(48);
  frame.row(35).setTo(cv::Scalar(50, 60, 65));
  auto patch = upright(12, false).patch(0);
  patch.left = patch.right = {20, 40, 60}, patch.middle = {50, 70, 90};
  const auto home =
      sketch::clamp_levels({{{{0}, {}, patch}}, {}}, sketch::measure_level_range(frame)).patch(0);
  CHECK(home.left == patch.left);
  CHECK_THAT(double{home.middle[0]}, Catch::Matchers::WithinAbs(50, 1e-3));
  CHECK_THAT(double{home.middle[1]}, Catch::Matchers::WithinAbs(40 + 20 / std::erf(std::sqrt(0.5)), 1e-3));
  CHECK_THAT(double{home.middle[2]}, Catch::Matchers::WithinAbs(60 + 5 / std::erf(std::sqrt(0.5)), 1e-3));
}

TEST_CASE("Seen levels: a picture on its side allows the same on its side") {
  core::Rng rng(8);
  cv::Mat levels(72, 96, CV_32F);
  for (int y = 0; y < levels.rows; y += 24)
    for (int x = 0; x < levels.cols; x += 24) levels(cv::Rect(x, y, 24, 24)).setTo(rng.below(256));
  const auto seen = sketch::measure_level_range(levels),
             turned = sketch::measure_level_range(cv::Mat(levels.t()));
  const auto clamped = [](graph::Point at, double theta, const sketch::LevelRange& range) {
    graph::Patch patch;
    patch.position = at, patch.theta = theta, patch.width = 2, patch.blur = 1, patch.contrast = 1;
    patch.left.fill(120), patch.right.fill(120), patch.middle.fill(121);
    return sketch::clamp_levels({{{{0}, {}, patch}}, {}}, range).patch(0);
  };
  int moved = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const double x = rng.uniform(8, 87), y = rng.uniform(8, 63);
    const auto upright = clamped({x, y}, 0, seen),
               lying = clamped({y, x}, std::numbers::pi / 2, turned);  // its left is the other's right
    CHECK_THAT(double{upright.left[0]}, WithinAbs(double{lying.right[0]}, 1e-2));
    CHECK_THAT(double{upright.right[0]}, WithinAbs(double{lying.left[0]}, 1e-2));
    moved += upright.left[0] != 120 ? 1 : 0;
  }
  CHECK(moved > 20);
}

TEST_CASE("Seen levels: whatever a place has shown it may show again") {
  core::Rng rng(6);
  cv::Mat levels(70, 100, CV_32FC3);
  for (auto& pixel : cv::Mat_<cv::Vec3f>(levels))
    for (int c = 0; c < 3; ++c) pixel[c] = static_cast<float>(rng.below(256));
  const auto seen = sketch::measure_level_range(levels);
  for (int trial = 0; trial < 300; ++trial) {
    const int x = 4 + static_cast<int>(rng.below(92)), y = static_cast<int>(rng.below(70));
    auto patch = upright(x, true).patch(0);
    patch.position.y = y, patch.blur = 1;  // its sides are told 2 px from it
    for (std::size_t c = 0; c < 3; ++c) {
      patch.left[c] = levels.at<cv::Vec3f>(y, x - 2)[static_cast<int>(c)];
      patch.right[c] = levels.at<cv::Vec3f>(y, x + 2)[static_cast<int>(c)];
    }
    const auto allowed = sketch::clamp_levels({{{{0}, {}, patch}}, {}}, seen).patch(0);
    for (std::size_t c = 0; c < 3; ++c) {
      CHECK(std::abs(allowed.left[c] - patch.left[c]) < 1e-3F);
      CHECK(std::abs(allowed.right[c] - patch.right[c]) < 1e-3F);
    }
  }
}

TEST_CASE("Seen levels: kept beside a model bit by bit, and refused where they do not fit") {
  sketch::LevelRange seen = sketch::measure_level_range(two_sides(48));
  core::ModelArchive archive;
  sketch::add_level_range(archive, {});
  CHECK(archive.arrays.empty());
  CHECK(sketch::read_level_range(archive, {100, 70}).empty());
  sketch::add_level_range(archive, seen);
  const auto read = sketch::read_level_range(archive, {100, 70});
  CHECK(cv::norm(read.low, seen.low, cv::NORM_INF) == 0);
  CHECK(cv::norm(read.high, seen.high, cv::NORM_INF) == 0);
  const auto refused = [](const core::ModelArchive& broken, const std::string& what) {
    CHECK(contains(message_of<core::IoError>([&] {
                     (void)sketch::read_level_range(broken, {100, 70});
                   }),
                   what));
  };
  auto broken = archive;
  broken.arrays.erase("seen_high");
  refused(broken, "seen_high.npy is missing");
  broken = archive;
  broken.arrays["seen_low"].shape = {13, 9, 3};
  refused(broken, "seen_low.npy is 13 x 9 x 3; expected uint8, 9 x 13 x 3");
  broken = archive;
  std::swap(broken.arrays["seen_low"], broken.arrays["seen_high"]);
  refused(broken, "lies above");
}
