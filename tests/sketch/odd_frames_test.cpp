// SPDX-License-Identifier: Apache-2.0
// Frames that are unusual but allowed, all the way from pixels to the filled frame; and those that are not.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "core/clip.hpp"
#include "core/error.hpp"
#include "sketch/extract.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/rendering/render.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::AttributeGraph;
using sketch::Sketchable;

namespace {

const cv::Size kOddFramesSize{96, 80};
const Point kFrom{20.3, 24.6}, kTo{74.8, 52.1};
constexpr double kLineWidth = 5;

/// A bar that lies askew to the pixel grid.
cv::Mat1f bar(double ground, double contrast) {
  return draw(kOddFramesSize, {segment(kFrom, kTo, kLineWidth, 1)}, ground, contrast);
}

double off_the_bar(Point p) {
  const Point along = (kTo - kFrom) * (1 / graph::distance(kFrom, kTo));
  return std::abs(graph::dot(p - kFrom, {-along.y, along.x}));
}

/// A stroke from left to right that a frame of any height at the top of the picture shows a part of.
AttributeGraph stroke(int patches) {
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (int i = 0; i < patches; ++i) {
    graph::Patch p;
    p.position = {5.0 * i, 0.3 + 0.1 * i};
    p.theta = 0.02;
    p.width = 2;
    p.contrast = 90;
    p.left = {50, 50, 50};
    p.middle = {150, 150, 150};
    p.right = {70, 70, 70};
    vertices.push_back({{static_cast<std::uint32_t>(i)}, {}, p});
    if (i > 0) edges.push_back({{static_cast<std::uint32_t>(i - 1)}, {static_cast<std::uint32_t>(i)}});
  }
  return {std::move(vertices), std::move(edges)};
}

bool same_bytes(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

}  // namespace

TEST_CASE("Frames of one or a few rows or columns are drawn as that part of a larger frame", "[sketch]") {
  const AttributeGraph graph = stroke(12);
  const cv::Size large(80, 60);
  const cv::Mat1f picture = draw(large, [](Point p) { return 40 + 2 * p.x + 3 * p.y; });
  const Sketchable fitted = sketch::draw_fitted(graph, large, 1),
                   pixels = sketch::draw_pixels(graph, picture);
  for (const cv::Size size :
       {cv::Size(1, 1), cv::Size(50, 1), cv::Size(1, 50), cv::Size(50, 3), cv::Size(3, 50)}) {
    INFO(size.width << " × " << size.height);
    const cv::Rect part({0, 0}, size);
    const Sketchable small = sketch::draw_fitted(graph, size, 1);
    REQUIRE(cv::countNonZero(small.mask) > 0);
    CHECK(same_bytes(small.mask, fitted.mask(part)));
    CHECK(same_bytes(small.levels, fitted.levels(part)));
    const Sketchable kept = sketch::draw_pixels(graph, picture(part).clone());
    CHECK(same_bytes(kept.levels, pixels.levels(part)));
    // Held pixels come back, and the others stay within their range.
    const sketch::FillResult filled = sketch::fill(small.levels, small.mask);
    CHECK(filled.converged);
    cv::Mat held;
    filled.levels.copyTo(held, small.mask);
    CHECK(same_bytes(held, small.levels));
    double low = 0, high = 0, least = 0, most = 0;
    cv::minMaxLoc(small.levels, &low, &high, nullptr, nullptr, small.mask);
    cv::minMaxLoc(filled.levels, &least, &most);
    CHECK(least >= low);
    CHECK(most <= high);
  }
}

TEST_CASE("Constant frames of any level have no strokes, and nothing to draw", "[sketch]") {
  for (const float level : {0.0F, 0.4F, 128.0F, 255.0F, -40.0F, 4000.0F})
    for (const int channels : {1, 3}) {
      INFO("level " << level << ", " << channels << " channels");
      const cv::Mat frame(kOddFramesSize, CV_32FC(channels), cv::Scalar::all(static_cast<double>(level)));
      const AttributeGraph found = sketch::extract(frame, {});
      REQUIRE(found.empty());
      CHECK(sketch::draw_fitted(found, kOddFramesSize, channels).share() == 0);
      CHECK(sketch::draw_pixels(found, frame).share() == 0);
    }
}

TEST_CASE("A black bar on white is a valley between white sides, and comes back with its pixels",
          "[sketch]") {
  const cv::Mat1f frame = bar(255, -255);
  const AttributeGraph found = sketch::extract(frame, {});
  REQUIRE(components(found).count == 1);
  REQUIRE(found.size() >= 10);
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found.degree(i) != 2) continue;
    const graph::Patch& p = found.patch(i);
    CHECK(off_the_bar(p.position) < 0.1);
    CHECK_THAT(p.contrast, WithinAbs(-255 * seen(0, kLineWidth, 1), 20));
    CHECK_THAT(static_cast<double>(p.left[0]), WithinAbs(255, 8));
    CHECK_THAT(static_cast<double>(p.right[0]), WithinAbs(255, 8));
  }
  const Sketchable held = sketch::draw_pixels(found, frame);
  const cv::Mat1f filled = sketch::fill(held.levels, held.mask).levels;
  const Point along = (kTo - kFrom) * (1 / graph::distance(kFrom, kTo));
  double worst = 0;  // but for the bar's square ends
  for (int y = 0; y < kOddFramesSize.height; ++y)
    for (int x = 0; x < kOddFramesSize.width; ++x) {
      const double s = graph::dot(Point{static_cast<double>(x), static_cast<double>(y)} - kFrom, along);
      if (s < 6 || s > graph::distance(kFrom, kTo) - 6) continue;
      worst = std::max(worst, static_cast<double>(std::abs(filled(y, x) - frame(y, x))));
    }
  CHECK(held.share() < 0.2);
  CHECK(worst < 25);
}

TEST_CASE("On a chequerboard of black and white squares every side is a step, and every step a side",
          "[sketch]") {
  for (const int side : {32, 48}) {
    const cv::Size size(6 * side, 5 * side);
    const cv::Mat1f frame = draw(size, [&](Point p) {
      return (static_cast<int>(p.x) / side + static_cast<int>(p.y) / side) % 2 == 0 ? 0.0 : 255.0;
    });
    std::vector<Point> steps;
    const AttributeGraph found = sketch::extract(frame, {});
    for (std::size_t i = 0; i < found.size(); ++i)
      if (graph::on_step(found.patch(i))) steps.push_back(found.patch(i).position);
    INFO("squares of " << side << " px, " << steps.size() << " step patches");
    const auto off_side = [&](double v) {  // the sides lie between pixels
      return std::abs(std::remainder(v + 0.5, side));
    };
    for (const Point p : steps) CHECK(std::min(off_side(p.x), off_side(p.y)) < 1);
    // The middles of the sides between two squares.
    for (int row = 0; row < 5; ++row)
      for (int column = 1; column < 6; ++column) {
        const Point middle{column * side - 0.5, row * side + side / 2.0 - 0.5};
        CHECK(std::ranges::any_of(steps, [&](Point p) { return graph::distance(p, middle) < 5; }));
      }
  }
}

TEST_CASE("A chequerboard of single pixels holds no stroke", "[sketch]") {
  const cv::Mat1f frame =
      draw(kOddFramesSize, [](Point p) { return static_cast<int>(p.x + p.y) % 2 == 0 ? 0.0 : 255.0; });
  CHECK(sketch::extract(frame, {}).empty());
}

TEST_CASE("A 16-bit frame gives the sketch of its 8-bit twin, and shows what 8 bits round away", "[sketch]") {
  cv::Mat bytes, words;
  bar(60, 80).convertTo(bytes, CV_8U);
  bytes.convertTo(words, CV_16U, 257);
  core::ClipInfo eight, sixteen;
  sixteen.depth = CV_16U;
  sixteen.white = 65535;
  const AttributeGraph a = sketch::extract(core::to_levels(bytes, eight), {}),
                       b = sketch::extract(core::to_levels(words, sixteen), {});
  REQUIRE(a.size() >= 8);
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    CHECK(graph::distance(a.patch(i).position, b.patch(i).position) < 1e-3);
    CHECK_THAT(a.patch(i).contrast, WithinAbs(b.patch(i).contrast, 0.05));
  }
  // A fifth of a grey level, under a white point that says so, is a bar as any other; 8 bits lose it.
  const cv::Mat1f faint = bar(0, 0.2);
  faint.convertTo(words, CV_16U, 257);
  faint.convertTo(bytes, CV_8U);
  core::ClipInfo dark = sixteen;
  dark.white = 0.2 * 257;
  const AttributeGraph found = sketch::extract(core::to_levels(words, dark), {});
  REQUIRE(found.size() >= 8);
  for (std::size_t i = 0; i < found.size(); ++i) CHECK(off_the_bar(found.patch(i).position) < 0.5);
  CHECK(sketch::extract(core::to_levels(bytes, eight), {}).empty());
}

TEST_CASE("Alpha is no level: four channels pass core unchanged and are refused by whatever draws",
          "[sketch]") {
  const cv::Mat frame(8, 8, CV_8UC4, cv::Scalar(10, 20, 30, 128));
  core::ClipInfo info;
  const cv::Mat levels = core::to_levels(frame, info);
  REQUIRE(levels.type() == CV_32FC4);
  CHECK(levels.at<cv::Vec4f>(3, 5) == cv::Vec4f(10, 20, 30, 128));
  const cv::Mat mask(8, 8, CV_8U, cv::Scalar(255));
  CHECK_THROWS_AS(sketch::extract(levels, {}), core::InputError);
  CHECK_THROWS_AS(sketch::draw_pixels(stroke(3), levels), core::InputError);
  CHECK_THROWS_AS(sketch::draw_fitted(stroke(3), {8, 8}, 4), core::InputError);
  CHECK_THROWS_AS(sketch::fill(levels, mask), core::InputError);
}

TEST_CASE("A number that is not finite matters where it is held, and nowhere else", "[sketch]") {
  const cv::Mat1f clean = bar(60, 80);
  const AttributeGraph found = sketch::extract(clean, {});
  const Sketchable kept = sketch::draw_pixels(found, clean);
  const cv::Mat filled = sketch::fill(kept.levels, kept.mask).levels;
  const cv::Point away(2, 2), on(cvRound((kFrom.x + kTo.x) / 2), cvRound((kFrom.y + kTo.y) / 2));
  REQUIRE(kept.mask.at<std::uint8_t>(away) == 0);
  REQUIRE(kept.mask.at<std::uint8_t>(on) == 255);
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity()}) {
    cv::Mat1f frame = clean.clone();
    frame(away) = bad;
    const Sketchable held = sketch::draw_pixels(found, frame);
    CHECK(same_bytes(held.levels, kept.levels));
    CHECK(same_bytes(sketch::fill(frame, held.mask).levels, filled));
    frame(on) = bad;
    const Sketchable broken = sketch::draw_pixels(found, frame);
    CHECK_FALSE(std::isfinite(broken.levels.at<float>(on)));
    CHECK_THROWS_AS(sketch::fill(broken.levels, broken.mask), core::InputError);
  }
}
