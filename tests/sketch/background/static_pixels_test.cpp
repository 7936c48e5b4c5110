// SPDX-License-Identifier: Apache-2.0
#include "sketch/background/static_pixels.hpp"

#include <limits>
#include <stop_token>
#include <string>

#include <opencv2/imgproc.hpp>

#include "core/context.hpp"
#include "core/error.hpp"
#include "core/rng.hpp"
#include "sketch/background/still_background.hpp"
#include "sketch/rendering/frame_renderer.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

const cv::Size kStaticPixelsSize(90, 60);

/// A grey wall with a dark pole, noisy, seen by a camera that shakes by a px; a bright bar passes the right
/// of it in one frame of twenty-five.
core::Clip wall(int frames, int type = CV_8UC3) {
  core::Clip clip{
      {kStaticPixelsSize.width, kStaticPixelsSize.height, CV_MAT_CN(type), CV_8U, 25, 255, frames}, {}};
  core::Rng rng(11);
  for (int t = 0; t < frames; ++t) {
    cv::Mat frame(kStaticPixelsSize, type, cv::Scalar(150, 140, 130));
    const int shaken = static_cast<int>(rng.below(3)) - 1;
    cv::rectangle(frame, cv::Rect(18 + shaken, 0, 12, kStaticPixelsSize.height), cv::Scalar(30, 40, 50),
                  cv::FILLED);
    cv::GaussianBlur(frame, frame, {}, 1.2);  // as lenses do
    if (t % 25 == 7)
      cv::rectangle(frame, cv::Rect(70, 0, 5, kStaticPixelsSize.height), cv::Scalar(240, 240, 240),
                    cv::FILLED);
    const cv::Mat noise = noise_frame(kStaticPixelsSize, type, static_cast<std::uint64_t>(t), 9);
    clip.frames.push_back(frame + noise - cv::Scalar(4, 4, 4));
  }
  return clip;
}

sketch::StaticPixels measured(const core::Clip& clip) {
  core::ClipSource source(clip);
  return sketch::find_static_pixels(source, {});
}

/// Draws new strokes on an even background of level 100.
sketch::RenderOptions even_background() {
  sketch::RenderOptions look{kStaticPixelsSize, 3};
  look.new_places = true;
  const std::vector<sketch::FrameBackground> seen{
      sketch::measure_background(cv::Mat(kStaticPixelsSize, CV_32FC3, cv::Scalar::all(100)), {})};
  look.background = sketch::estimate_background(seen);
  return look;
}

}  // namespace

TEST_CASE("Backdrop: still is what noise and shaking alone move, even where something rarely passes") {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    const auto static_pixels = measured(wall(100, type));
    REQUIRE(static_pixels.levels.type() == type);
    REQUIRE(static_pixels.levels.size() == kStaticPixelsSize);
    const auto still = [&](int x) { return static_pixels.still.at<uchar>(30, x) == 255; };
    for (const int x : {0, 10, 20, 23, 25, 40, 60, 67, 77, 89}) {
      CAPTURE(x);
      CHECK(still(x));
    }
    for (int x = 68; x < 77; ++x) {
      CAPTURE(x);
      CHECK_FALSE(still(x));
      CHECK(static_pixels.levels.ptr(30)[x * static_pixels.levels.channels()] == 0);
    }
    CHECK(std::abs(int{static_pixels.levels.ptr(30)[40 * static_pixels.levels.channels()]} - 150) <= 1);
    CHECK(std::abs(int{static_pixels.levels.ptr(30)[23 * static_pixels.levels.channels()]} - 30) <= 2);
  }
}

TEST_CASE("Backdrop: of long clips some frames tell, of one frame all is still") {
  const auto static_pixels = measured(wall(600));
  CHECK(static_pixels.still.at<uchar>(30, 40) == 255);
  CHECK(cv::countNonZero(measured(wall(1)).still) == kStaticPixelsSize.area());
  std::stop_source stop;
  stop.request_stop();
  const auto clip = wall(3);
  core::ClipSource source(clip);
  CHECK_THROWS_AS(sketch::find_static_pixels(source, core::Context(stop.get_token())), core::Cancelled);
}

TEST_CASE("Backdrop: strokes of a new clip pass behind it, and nothing else of it changes") {
  sketch::RenderOptions look = even_background();
  look.background.level_range = {};
  look.background.still = 0;
  std::vector<graph::Vertex> vertices;
  for (std::uint32_t i = 0; i < 12; ++i) {
    graph::Patch patch;
    patch.position = {10 + 6.0 * i, 30};
    patch.width = 4, patch.blur = 1, patch.contrast = 80;
    patch.left = patch.right = {100, 100, 100}, patch.middle = {190, 180, 170};
    vertices.push_back({{i}, {}, patch});
  }
  const graph::AttributeGraph strokes(vertices, {});
  const cv::Mat without = sketch::render_frame(strokes, look);
  look.background.static_pixels = {cv::Mat(kStaticPixelsSize, CV_8UC3, cv::Scalar(7, 8, 9)),
                                   cv::Mat::zeros(kStaticPixelsSize, CV_8U)};
  look.background.static_pixels.still.colRange(0, 40) = 255;
  sketch::FrameContent parts{strokes};
  for (const float opacity : {1.0F, 0.5F}) {
    parts.opacity.assign(vertices.size(), opacity);
    const cv::Mat drawn = sketch::render_frame(parts, look);
    CAPTURE(opacity);
    CHECK(cv::norm(drawn.colRange(0, 34), cv::Mat(60, 34, CV_8UC3, cv::Scalar(7, 8, 9)), cv::NORM_INF) == 0);
    // Over 6 px it takes more and more of them.
    for (int x = 34; opacity == 1 && x < 40; ++x)
      CHECK(drawn.at<cv::Vec3b>(30, x)[0] < drawn.at<cv::Vec3b>(30, x + 1)[0]);
    if (opacity == 1) CHECK(drawn.at<cv::Vec3b>(30, 64)[0] > 180);
  }
  CHECK(without.at<cv::Vec3b>(30, 22)[0] > 180);
}

TEST_CASE("Backdrop: a frame without a stroke shows it") {
  sketch::RenderOptions look = even_background();
  look.background.static_pixels = {cv::Mat(kStaticPixelsSize, CV_8UC3, cv::Scalar(7, 8, 9)),
                                   cv::Mat(kStaticPixelsSize, CV_8U, cv::Scalar(255))};
  CHECK(cv::norm(sketch::render_frame(sketch::FrameContent{}, look),
                 cv::Mat(kStaticPixelsSize, CV_8UC3, cv::Scalar(7, 8, 9)), cv::NORM_INF) == 0);
}

TEST_CASE("Backdrop: kept beside a model, bit by bit, and refused where it does not fit") {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    const auto static_pixels = measured(wall(30, type));
    core::ModelArchive archive;
    CHECK(sketch::read_static_pixels(archive, kStaticPixelsSize).empty());
    sketch::add_static_pixels(archive, static_pixels);
    const auto read = sketch::read_static_pixels(archive, kStaticPixelsSize);
    CHECK(same_pixels(read.levels, static_pixels.levels));
    CHECK(same_pixels(read.still, static_pixels.still));
    const auto refusal = [&](const core::ModelArchive& from, cv::Size frame) {
      return message_of<core::IoError>([&] { sketch::read_static_pixels(from, frame); });
    };
    const std::string channels = type == CV_8UC1 ? "1" : "3";
    CHECK(refusal(archive, {90, 61}) ==
          "motion model: backdrop.npy is 60 x 90 x " + channels + "; expected uint8, 61 x 90 x " + channels);
    auto broken = archive;
    broken.arrays.erase("backdrop");
    CHECK(refusal(broken, kStaticPixelsSize) == "motion model: backdrop.npy is missing");
    broken = archive;
    broken.arrays.erase("backdrop_still");
    CHECK(refusal(broken, kStaticPixelsSize) == "motion model: backdrop_still.npy is missing");
    broken = archive;
    broken.arrays["backdrop_still"].data = std::vector<float>(5400, 1);
    CHECK_THAT(refusal(broken, kStaticPixelsSize), Catch::Matchers::Contains("expected uint8"));
  }
}
