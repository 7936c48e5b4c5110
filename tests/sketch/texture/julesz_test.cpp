// SPDX-License-Identifier: Apache-2.0
#include "sketch/texture/julesz.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <stop_token>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/clip.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "tests/sketch/texture/texture_scene.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

TextureScene two_textures() {
  cv::Mat frame = test::texture(kTextureSize, 4, 120, 1);
  test::texture({kTextureSize.width / 2, kTextureSize.height}, 5, 120, 2)
      .copyTo(frame.colRange(0, kTextureSize.width / 2));
  return texture_scene(frame, test::bands(kTextureSize), 2);
}

/// The distance from newly measured histograms.
double distance_of(const cv::Mat& levels, const sketch::TextureRegions& regions) {
  const auto own = sketch::measure_region_histograms(core::to_bytes(core::luma(levels)), regions);
  double sum = 0;
  for (std::size_t k = 0; k < own.size(); ++k)
    sum += sketch::histogram_distance(own[k], regions.histograms[k]) *
           cv::countNonZero(regions.part == static_cast<int>(k + 1));
  return sum / cv::countNonZero(regions.label);
}

}  // namespace

TEST_CASE("A sample of the Julesz ensemble has the histograms it was asked for", "[sketch][julesz]") {
  for (const int kind : {0, 3, 4, 5}) {
    INFO("texture " << kind);
    const TextureScene s =
        texture_scene(test::texture(kTextureSize, kind, 120, 3), test::bands(kTextureSize), 1);
    const auto result = sketch::julesz(s.start, s.regions);
    // The distances told, by sums updated move by move, are those of the pictures.
    CHECK_THAT(result.before, WithinAbs(distance_of(s.start, s.regions), 1e-9));
    CHECK_THAT(result.after, WithinAbs(distance_of(result.levels, s.regions), 1e-9));
    CHECK(result.before > 0.25);
    CHECK(result.after < 0.06);
    CHECK(result.after < result.before / 8);
    CHECK(same_where_held(result.levels, s.frame, s.mask));
    // It is another picture, not the one that was observed.
    CHECK(cv::norm(result.levels, s.frame, cv::NORM_L1, s.mask == 0) / cv::countNonZero(s.mask == 0) > 5);
  }
}

TEST_CASE("Each region gets its own texture", "[sketch][julesz]") {
  const TextureScene s = two_textures();
  const auto result = sketch::julesz(s.start, s.regions);
  CHECK(result.after < 0.06);
  CHECK_THAT(result.after, WithinAbs(distance_of(result.levels, s.regions), 1e-9));
  // Upright on the left, level on the right.
  const auto slopes = [&](const cv::Mat& levels, int dx, int dy, int from, int to) {
    double sum = 0;
    for (int y = 2; y < kTextureSize.height - 2; ++y)
      for (int x = from; x < to; ++x)
        if (s.mask.at<uchar>(y, x) == 0)
          sum +=
              std::abs(double(levels.at<float>(y + dy, x + dx)) - double(levels.at<float>(y - dy, x - dx)));
    return sum;
  };
  for (const int from : {4, 56}) {
    const auto ratio = [&](const cv::Mat& levels) {
      return slopes(levels, 1, 0, from, from + 36) / slopes(levels, 0, 1, from, from + 36);
    };
    CHECK((ratio(s.frame) > 1.4 || ratio(s.frame) < 0.7));
    CHECK_THAT(ratio(result.levels), Catch::Matchers::WithinRel(ratio(s.frame), 0.3));
  }
}

TEST_CASE("More sweeps come closer", "[sketch][julesz]") {
  const TextureScene s = two_textures();
  double before = 1;
  for (const int sweeps : {1, 4, 16, 64}) {
    const double after = sketch::julesz(s.start, s.regions, {.sweeps = sweeps}).after;
    CHECK(after < before);
    before = after;
  }
}

TEST_CASE("Julesz: same seed same bytes at any thread count and other seeds other bytes",
          "[sketch][julesz]") {
  const TextureScene s = two_textures();
  const auto with = [&](std::size_t threads, std::uint64_t seed) {
    const core::ThreadLimit limit(threads);
    return sketch::julesz(s.start, s.regions, {.sweeps = 5, .seed = seed}).levels;
  };
  const cv::Mat one = with(1, 1);
  CHECK(cv::norm(one, with(4, 1), cv::NORM_INF) == 0);
  CHECK(cv::norm(one, with(1, 2), cv::NORM_L1) > kTextureSize.area());
}

TEST_CASE("Julesz in colour changes luma alone", "[sketch][julesz]") {
  const TextureScene grey = two_textures();
  cv::Mat frame;
  cv::merge(std::vector<cv::Mat>{cv::Mat(grey.frame - 20), grey.frame, cv::Mat(grey.frame + 30)}, frame);
  const TextureScene s = texture_scene(frame, grey.mask, 2);
  const auto result = sketch::julesz(s.start, s.regions, {.sweeps = 8});
  CHECK(same_where_held(result.levels, frame, s.mask));
  CHECK_THAT(result.after, WithinAbs(distance_of(result.levels, s.regions), 0.02));  // but for saturation
  double apart = 0;
  for (int y = 0; y < kTextureSize.height; ++y)
    for (int x = 0; x < kTextureSize.width; ++x) {
      const auto a = s.start.at<cv::Vec3f>(y, x), b = result.levels.at<cv::Vec3f>(y, x);
      for (int c = 0; c < 3; ++c) CHECK((b[c] >= -21 && b[c] <= 285));
      if (b[0] > 0 && b[2] < 255) apart = std::max(apart, double(std::abs((b[2] - b[0]) - (a[2] - a[0]))));
    }
  CHECK(apart < 1e-3);
}

TEST_CASE("Julesz on odd frames and when nothing is free", "[sketch][julesz]") {
  for (const cv::Size size : {cv::Size(1, 1), {3, 1}, {3, 30}, {30, 3}, {2, 2}, {9, 8}}) {
    const cv::Mat frame = test::texture(size, 3, 100, 4);
    const auto regions = sketch::segment_texture(frame, test::nothing(size));
    const cv::Mat flat(size, CV_32F, cv::Scalar(100));
    const auto result = sketch::julesz(flat, regions);
    INFO(size.width << " × " << size.height);
    CHECK(result.levels.size() == size);
    CHECK(result.after <= result.before);
    CHECK_THAT(result.after, WithinAbs(distance_of(result.levels, regions), 1e-9));
    const cv::Mat all(size, CV_8U, cv::Scalar(255));
    const auto none = sketch::julesz(frame, sketch::segment_texture(frame, all));
    CHECK(cv::norm(none.levels, frame, cv::NORM_INF) == 0);
    CHECK(none.before == 0);
  }
  const cv::Mat constant(kTextureSize, CV_32F, cv::Scalar(80));
  const auto still = sketch::julesz(constant, sketch::segment_texture(constant, test::nothing(kTextureSize)));
  CHECK(cv::norm(still.levels, constant, cv::NORM_INF) <= 1);
  const cv::Mat white(kTextureSize, CV_32F, cv::Scalar(255));
  CHECK(cv::norm(sketch::julesz(white, sketch::segment_texture(white, test::nothing(kTextureSize))).levels,
                 white, cv::NORM_INF) <= 1);
}

TEST_CASE("Julesz can be stopped and tells how far it is", "[sketch][julesz]") {
  const TextureScene s = two_textures();
  std::stop_source stop;
  double told = 0;
  const core::Context context(stop.get_token(), [&](std::string_view, double share) {
    told = share;
    if (share >= 0.5) stop.request_stop();
  });
  CHECK_THROWS_AS(sketch::julesz(s.start, s.regions, {.sweeps = 8}, context), core::Cancelled);
  CHECK_THAT(told, WithinAbs(0.5, 1e-12));
}

TEST_CASE("Julesz rejects what is none", "[sketch][julesz]") {
  TextureScene s = two_textures();
  for (const sketch::JuleszOptions& options : std::vector<sketch::JuleszOptions>{
           {.sweeps = 0}, {.hottest = 0}, {.coldest = 0}, {.hottest = 1, .coldest = 2}})
    CHECK_THROWS_AS(sketch::julesz(s.start, s.regions, options), core::InputError);
  CHECK_THROWS_AS(sketch::julesz(cv::Mat(), s.regions), core::InputError);
  CHECK_THROWS_AS(sketch::julesz(s.start(cv::Rect(0, 0, 5, 5)), s.regions), core::InputError);
  sketch::TextureRegions fewer = s.regions;
  fewer.count = 1;
  CHECK_THROWS_AS(sketch::julesz(s.start, fewer), core::InputError);
  s.start.at<float>(2, 2) = std::numeric_limits<float>::quiet_NaN();
  CHECK_THROWS_AS(sketch::julesz(s.start, s.regions), core::InputError);
}
