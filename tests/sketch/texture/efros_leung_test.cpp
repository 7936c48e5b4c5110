// SPDX-License-Identifier: Apache-2.0
#include "sketch/texture/efros_leung.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <set>
#include <stop_token>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "tests/sketch/texture/texture_scene.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

/// A tile of 7 × 5 different levels, again and again.
cv::Mat periodic(cv::Size size) {
  cv::Mat frame(size, CV_32F);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      frame.at<float>(y, x) = static_cast<float>(20 + (x % 7 * 31 + y % 5 * 47 + x % 7 * (y % 5) * 11) % 200);
  return frame;
}

}  // namespace

TEST_CASE("Efros-Leung carries a periodic texture on in phase with what is held", "[sketch][efros_leung]") {
  const cv::Mat frame = periodic(kTextureSize);
  const TextureScene s = texture_scene(frame, test::bands(kTextureSize));
  const cv::Mat drawn = sketch::efros_leung(s.start, frame, s.regions).levels;
  CHECK(cv::countNonZero(drawn == frame) > 0.99 * kTextureSize.area());
  // With nothing held there is no phase but the period remains.
  const TextureScene free = texture_scene(frame, test::nothing(kTextureSize));
  const cv::Mat grown = sketch::efros_leung(free.start, frame, free.regions).levels;
  CHECK(cv::countNonZero(grown.colRange(7, 96) == grown.colRange(0, 89)) > 0.95 * 89 * 72);
  CHECK(cv::countNonZero(grown.rowRange(5, 72) == grown.rowRange(0, 67)) > 0.95 * 67 * 96);
}

TEST_CASE("Efros-Leung copies pixels of the own region from elsewhere", "[sketch][efros_leung]") {
  cv::Mat frame = test::texture(kTextureSize, 4, 90, 1);
  test::texture({kTextureSize.width / 2, kTextureSize.height}, 5, 150, 2)
      .copyTo(frame.colRange(0, kTextureSize.width / 2));
  for (const int channels : {1, 3}) {
    cv::Mat levels = frame;
    if (channels == 3)
      cv::merge(std::vector<cv::Mat>{frame, cv::Mat(frame * 0.5), cv::Mat(255 - frame)}, levels);
    const TextureScene s = texture_scene(levels, test::bands(kTextureSize), 2);
    const sketch::EfrosLeungOptions options;
    const auto result = sketch::efros_leung(s.start, levels, s.regions, options);
    CHECK(same_where_held(result.levels, levels, s.mask));
    int moved = 0, free = 0;
    for (int y = 0; y < kTextureSize.height; ++y)
      for (int x = 0; x < kTextureSize.width; ++x) {
        const auto from = result.source.at<cv::Vec2i>(y, x);
        if (s.mask.at<uchar>(y, x) != 0) {
          CHECK(from == cv::Vec2i(-1, -1));
          continue;
        }
        ++free;
        REQUIRE(
            (from[0] >= 0 && from[1] >= 0 && from[0] < kTextureSize.width && from[1] < kTextureSize.height));
        CHECK(std::memcmp(result.levels.ptr(y, x), levels.ptr(from[1], from[0]), levels.elemSize()) == 0);
        CHECK(s.regions.label.at<uchar>(from[1], from[0]) == s.regions.label.at<uchar>(y, x));
        moved += std::max(std::abs(from[0] - x), std::abs(from[1] - y)) > options.window / 2 ? 1 : 0;
      }
    CHECK(moved == free);
  }
}

TEST_CASE("Efros-Leung goes on with what it copied, along x as along y", "[sketch][efros_leung]") {
  const cv::Mat frame = test::texture(kTextureSize, 4, 90, 1);
  const TextureScene s = texture_scene(frame, test::bands(kTextureSize));
  const auto result = sketch::efros_leung(s.start, frame, s.regions);
  const auto share_that_goes_on = [&](int dx, int dy) {
    int pairs = 0, on = 0;
    for (int y = 0; y + dy < kTextureSize.height; ++y)
      for (int x = 0; x + dx < kTextureSize.width; ++x) {
        const auto from = result.source.at<cv::Vec2i>(y, x),
                   next = result.source.at<cv::Vec2i>(y + dy, x + dx);
        if (from[0] < 0 || next[0] < 0) continue;
        ++pairs;
        on += next == from + cv::Vec2i(dx, dy) ? 1 : 0;
      }
    REQUIRE(pairs > 500);
    return static_cast<double>(on) / pairs;
  };
  const double across = share_that_goes_on(1, 0), down = share_that_goes_on(0, 1);
  CHECK(across > 0.25);
  CHECK(down > 0.25);
}

TEST_CASE("Efros-Leung keeps the look of a grain", "[sketch][efros_leung]") {
  for (const int kind : {0, 3, 4}) {
    const TextureScene s =
        texture_scene(test::texture(kTextureSize, kind, 120, 3), test::bands(kTextureSize));
    const cv::Mat drawn = sketch::efros_leung(s.start, s.frame, s.regions).levels;
    INFO("texture " << kind);
    cv::Scalar mean, sd, own_mean, own_sd;
    cv::meanStdDev(s.frame, mean, sd, s.mask == 0);
    cv::meanStdDev(drawn, own_mean, own_sd, s.mask == 0);
    CHECK(std::abs(mean[0] - own_mean[0]) < 0.35 * sd[0]);
    CHECK(own_sd[0] > 0.7 * sd[0]);
    CHECK(own_sd[0] < 1.3 * sd[0]);
    // No garbage: it does not grow from a handful of pixels.
    const auto result = sketch::efros_leung(s.start, s.frame, s.regions);
    std::set<std::pair<int, int>> places;
    for (int y = 0; y < kTextureSize.height; ++y)
      for (int x = 0; x < kTextureSize.width; ++x)
        if (const auto from = result.source.at<cv::Vec2i>(y, x); from[0] >= 0)
          places.emplace(from[0], from[1]);
    CHECK(double(places.size()) > 0.1 * cv::countNonZero(s.mask == 0));
  }
}

TEST_CASE("Efros-Leung: same seed same bytes at any thread count and other seeds other bytes",
          "[sketch][efros_leung]") {
  const TextureScene s = texture_scene(test::texture(kTextureSize, 0, 120, 3), test::bands(kTextureSize));
  const auto with = [&](std::size_t threads, std::uint64_t seed) {
    const core::ThreadLimit limit(threads);
    return sketch::efros_leung(s.start, s.frame, s.regions, {.seed = seed}).levels;
  };
  const cv::Mat one = with(1, 1);
  CHECK(cv::norm(one, with(4, 1), cv::NORM_INF) == 0);
  CHECK(cv::norm(one, with(1, 2), cv::NORM_L1) > kTextureSize.area());
}

TEST_CASE("Efros-Leung on odd frames and when nothing is free", "[sketch][efros_leung]") {
  for (const cv::Size size : {cv::Size(1, 1), {3, 1}, {3, 30}, {30, 3}, {2, 2}, {9, 8}}) {
    INFO(size.width << " × " << size.height);
    const cv::Mat frame = test::texture(size, 3, 100, 4);
    const TextureScene free = texture_scene(frame, test::nothing(size));
    const auto result = sketch::efros_leung(free.start, frame, free.regions);
    REQUIRE(result.levels.size() == size);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const auto from = result.source.at<cv::Vec2i>(y, x);
        REQUIRE(from[0] >= 0);
        CHECK(result.levels.at<float>(y, x) == frame.at<float>(from[1], from[0]));
      }
    const TextureScene held = texture_scene(frame, cv::Mat(size, CV_8U, cv::Scalar(255)));
    CHECK(cv::norm(sketch::efros_leung(frame, frame, held.regions).levels, frame, cv::NORM_INF) == 0);
    cv::Mat one_free(size, CV_8U, cv::Scalar(255));
    one_free.at<uchar>(size.height / 2, 0) = 0;
    const TextureScene one = texture_scene(frame, one_free);
    CHECK(cv::norm(sketch::efros_leung(one.start, frame, one.regions).levels, frame, cv::NORM_INF) == 0);
  }
  const cv::Mat constant(kTextureSize, CV_32F, cv::Scalar(80));
  const TextureScene still = texture_scene(constant, test::bands(kTextureSize));
  CHECK(cv::norm(sketch::efros_leung(still.start, constant, still.regions).levels, constant, cv::NORM_INF) ==
        0);
}

TEST_CASE("Efros-Leung can be stopped", "[sketch][efros_leung]") {
  const TextureScene s = texture_scene(test::texture(kTextureSize, 0, 120, 3), test::bands(kTextureSize));
  std::stop_source stop;
  const core::Context context(stop.get_token(), [&](std::string_view, double share) {
    if (share > 0.2) stop.request_stop();
  });
  CHECK_THROWS_AS(sketch::efros_leung(s.start, s.frame, s.regions, {}, context), core::Cancelled);
}

TEST_CASE("Efros-Leung rejects what is none", "[sketch][efros_leung]") {
  TextureScene s = texture_scene(test::texture(kTextureSize, 0, 120, 3), test::bands(kTextureSize));
  for (const sketch::EfrosLeungOptions& options : std::vector<sketch::EfrosLeungOptions>{
           {.window = 4}, {.window = 33}, {.tolerance = -1}, {.candidates = 0}, {.guidance = 1.5}})
    CHECK_THROWS_AS(sketch::efros_leung(s.start, s.frame, s.regions, options), core::InputError);
  CHECK_THROWS_AS(sketch::efros_leung(cv::Mat(), s.frame, s.regions), core::InputError);
  CHECK_THROWS_AS(sketch::efros_leung(s.start, cv::Mat(3, 3, CV_32F), s.regions), core::InputError);
  CHECK_THROWS_AS(sketch::efros_leung(s.start, s.frame, sketch::TextureRegions{}), core::InputError);
  sketch::TextureRegions fewer = s.regions;
  fewer.count = 0;
  CHECK_THROWS_AS(sketch::efros_leung(s.start, s.frame, fewer), core::InputError);
  s.frame.at<float>(2, 2) = std::numeric_limits<float>::quiet_NaN();
  CHECK_THROWS_AS(sketch::efros_leung(s.start, s.frame, s.regions), core::InputError);
}
