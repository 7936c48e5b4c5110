// SPDX-License-Identifier: Apache-2.0
#include "sketch/background/still_background.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "sketch/rendering/frame_renderer.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;

namespace {

/// An upright bright line of patches about x.
graph::AttributeGraph line(double x, double top, double bottom) {
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (double y = top; y <= bottom; y += 5) {
    graph::Patch patch;
    patch.position = {x, y};
    patch.theta = 1.5707963;
    patch.width = 3, patch.blur = 1, patch.contrast = 100;
    patch.left = patch.right = {80, 80, 80}, patch.middle = {180, 180, 180};
    const auto id = static_cast<std::uint32_t>(vertices.size());
    vertices.push_back({{id}, {}, patch});
    if (id > 0) edges.push_back({{id - 1}, {id}});
  }
  return {std::move(vertices), std::move(edges)};
}

/// A frame that rises by half a level a pixel to the right, 100 × 70 px: its last cells are cut.
cv::Mat slope(double from = 20) {
  cv::Mat levels(70, 100, CV_32F);
  for (int y = 0; y < levels.rows; ++y)
    for (int x = 0; x < levels.cols; ++x) levels.at<float>(y, x) = static_cast<float>(from + 0.5 * x);
  return levels;
}

std::string refusal(const core::ModelArchive& archive, cv::Size frame) {
  return test::message_of<core::IoError>([&] { sketch::read_background(archive, frame); });
}

}  // namespace

TEST_CASE("Ground: a cell is the mean of its pixels, closed where a patch is near") {
  const auto background = sketch::measure_background(slope(), line(24, 24, 40));
  REQUIRE(background.levels.size() == cv::Size(7, 5));
  CHECK_THAT(background.levels.at<float>(1, 1), Catch::Matchers::WithinAbs(20 + 0.5 * 23.5, 1e-3));
  // The patches at x = 24, y = 24 … 39 reach 8 px: the cells from x = 16 to 32 and y = 16 to 47.
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 7; ++x) {
      CAPTURE(x, y);
      CHECK((background.uncovered.at<uchar>(y, x) == 0) == ((x == 1 || x == 2) && (y == 1 || y == 2)));
    }
}

TEST_CASE("Ground: still is what is seen often enough and keeps its level") {
  std::vector<sketch::FrameBackground> frames;
  for (int t = 0; t < 40; ++t) {
    cv::Mat levels = slope();
    levels(cv::Rect(0, 0, 16, 16)) += t % 2 == 0 ? 0.0 : 40.0;  // flickers by SD 20
    levels(cv::Rect(16, 0, 16, 16)) += t % 2 == 0 ? 0.0 : 8.0;  // by SD 4
    // A line that stands before one cell in all frames but five.
    frames.push_back(sketch::measure_background(levels, t < 35 ? line(56, 24, 30) : graph::AttributeGraph{}));
  }
  const auto background = sketch::estimate_background(frames);
  CHECK(background.still.at<uchar>(0, 0) == 0);
  CHECK(background.still.at<uchar>(0, 1) == 255);
  CHECK_THAT(background.levels.at<float>(0, 1), Catch::Matchers::WithinAbs(20 + 0.5 * 23.5 + 4, 1e-3));
  CHECK(background.still.at<uchar>(1, 3) == 0);
  CHECK(background.still.at<uchar>(4, 5) == 255);
}

TEST_CASE("Ground: seen in a fifth of the frames is often enough, an SD of 8 levels is not still") {
  std::vector<sketch::FrameBackground> frames;
  for (int t = 0; t < 20; ++t) {
    const float sign = t % 2 == 0 ? 1.0F : -1.0F;
    cv::Mat1f levels = (cv::Mat1f(1, 4) << 100 + 7.5F * sign, 100 + 8.5F * sign, 60, 60);
    cv::Mat1b uncovered(1, 4, std::uint8_t{255});
    uncovered(0, 2) = t < 4 ? 255 : 0;
    uncovered(0, 3) = t < 3 ? 255 : 0;
    frames.push_back({levels, uncovered});
  }
  const auto background = sketch::estimate_background(frames);
  const std::vector<int> still{255, 0, 255, 0};
  for (int x = 0; x < 4; ++x) CHECK(background.still.at<uchar>(0, x) == still[static_cast<std::size_t>(x)]);
  CHECK_THAT(background.levels.at<float>(0, 0), Catch::Matchers::WithinAbs(100, 1e-3));
  CHECK(background.levels.at<float>(0, 2) == 60);
}

TEST_CASE("Ground: frames keep it away from strokes, and strokes keep their place") {
  const std::vector<sketch::FrameBackground> seen{sketch::measure_background(slope(), {})};
  const auto background = sketch::estimate_background(seen);
  const auto graph = line(50, 0, 69);
  const auto alone = sketch::draw_fitted(graph, {100, 70}, 1);
  const auto drawn =
      sketch::render_around(alone, cv::Scalar::all(0), sketch::expand_background(background, {100, 70}, 1));
  CHECK(drawn.share == alone.share());
  for (int y = 0; y < 70; ++y)
    for (int x = 0; x < 100; ++x) {
      if (alone.mask.at<uchar>(y, x) != 0)
        CHECK(drawn.levels.at<float>(y, x) == alone.levels.at<float>(y, x));
      // Linear between the cells' middles, 7.5 to 87.5; the last column of cells is cut and sees its mean.
      if (std::abs(x - 50) > 20 && x >= 8 && x < 88)
        CHECK_THAT(drawn.levels.at<float>(y, x), Catch::Matchers::WithinAbs(20 + 0.5 * x, 0.6));
    }
  // Without strokes the ground is all there is; without either the level that is told.
  CHECK_THAT(sketch::render_around(sketch::draw_fitted({}, {100, 70}, 3), cv::Scalar::all(9),
                                   sketch::expand_background(background, {100, 70}, 3))
                 .levels.at<cv::Vec3f>(30, 40)[2],
             Catch::Matchers::WithinAbs(40, 0.6));
  CHECK(sketch::render_around(sketch::draw_fitted({}, {100, 70}, 1), cv::Scalar::all(9))
            .levels.at<float>(3, 3) == 9);
}

TEST_CASE("Ground: kept beside a model, bit by bit, and refused where it does not fit") {
  const std::vector<sketch::FrameBackground> seen{sketch::measure_background(slope(), line(24, 24, 40))};
  const auto background = sketch::estimate_background(seen);
  core::ModelArchive archive;
  CHECK(sketch::read_background(archive, {100, 70}).empty());
  sketch::add_background(archive, background);
  const auto read = sketch::read_background(archive, {100, 70});
  CHECK(cv::countNonZero(read.levels != background.levels) == 0);
  CHECK(cv::countNonZero(read.still != background.still) == 0);

  CHECK(refusal(archive, {200, 70}) == "motion model: ground.npy is 5 x 7 x 1; expected float32, 5 x 13 x 1");
  auto broken = archive;
  std::get<std::vector<float>>(broken.arrays["ground"].data)[3] = std::numeric_limits<float>::quiet_NaN();
  CHECK_THAT(refusal(broken, {100, 70}), Catch::Matchers::Contains("ground.npy holds a number"));
  broken = archive;
  broken.arrays["ground_still"].shape = {7, 5};
  CHECK_THAT(refusal(broken, {100, 70}), Catch::Matchers::Contains("ground_still.npy is 7 x 5"));
  broken.arrays.erase("ground_still");
  CHECK_THAT(refusal(broken, {100, 70}), Catch::Matchers::Contains("ground_still.npy is missing"));
}
