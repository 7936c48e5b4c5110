// SPDX-License-Identifier: Apache-2.0
#include "sketch/steadying/steady_sketch.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::AttributeGraph;
using sketch::CarriedSketch;

namespace {

const cv::Size kSteadySketchSize{160, 120};
const sketch::ExtractOptions kOptions;
constexpr double kNoise = 3;

/// A strong stroke at the height 30 + moved, and one of contrast `other` at 80 + moved, in noise.
cv::Mat1f frame_of(double moved, double other, std::uint64_t seed) {
  return with_noise(draw(kSteadySketchSize,
                         [=](Point p) {
                           return 60 + 80 * segment({20, 30 + moved}, {140, 34 + moved}, 4, 1)(p) +
                                  other * segment({40, 80 + moved}, {110, 80 + moved}, 4, 1)(p);
                         }),
                    kNoise, seed);
}

/// The sketch without the stroke about the height y.
AttributeGraph without(const AttributeGraph& graph, double y) {
  const auto stays = [&](const graph::Patch& patch) { return std::abs(patch.position.y - y) > 6; };
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (const graph::Vertex& v : graph.vertices())
    if (stays(v.patch)) vertices.push_back(v);
  for (const graph::Edge& e : graph.edges())
    if (stays(graph.patch(graph.index_of(e.a))) && stays(graph.patch(graph.index_of(e.b))))
      edges.push_back(e);
  return {std::move(vertices), std::move(edges)};
}

std::ptrdiff_t patches_about(const AttributeGraph& graph, double y) {
  return std::ranges::count_if(graph.vertices(),
                               [&](const auto& v) { return std::abs(v.patch.position.y - y) < 3; });
}

cv::Mat even_motion(float x, float y) {
  return cv::Mat(kSteadySketchSize, CV_32FC2, cv::Scalar(double{x}, double{y}));
}

/// A frame `moved` px lower than this one, as its neighbour.
CarriedSketch neighbour(const cv::Mat1f& frame, const cv::Mat1f& other, const AttributeGraph& sketch,
                        float moved) {
  return {sketch::carry_sketch(sketch, even_motion(0, -moved), kSteadySketchSize),
          sketch::measure_difference(frame, other, even_motion(0, moved))};
}

}  // namespace

TEST_CASE("A sketch is carried by the motion, of whatever grid it is", "[sketch][steady]") {
  const AttributeGraph graph = sketch::extract(frame_of(0, 60, 1), kOptions);
  cv::Mat motion(30, 40, CV_32FC2);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) motion.at<cv::Vec2f>(y, x) = {0.1F * static_cast<float>(4 * x), -2.0F};
  const AttributeGraph carried = sketch::carry_sketch(graph, motion, kSteadySketchSize);
  REQUIRE(carried.size() == graph.size());
  CHECK(std::ranges::equal(carried.edges(), graph.edges()));
  for (std::size_t i = 0; i < graph.size(); ++i) {
    const Point from = graph.patch(i).position, to = carried.patch(i).position;
    // Vector x stands in the middle of the pixels 4x … 4x + 3.
    CHECK(std::abs(to.x - from.x - 0.1 * (from.x - 1.5)) < 1e-4);
    CHECK(std::abs(to.y - from.y + 2) < 1e-6);
  }
}

TEST_CASE("Frames that the motion makes alike differ by their noise alone", "[sketch][steady]") {
  const cv::Mat1f here = frame_of(0, 60, 1), moved = frame_of(2, 60, 2);
  const cv::Mat1f alike = sketch::measure_difference(here, moved, even_motion(0, 2)),
                  apart = sketch::measure_difference(here, moved, even_motion(0, 0));
  const double noise = kNoise * std::sqrt(2);
  CHECK(double{alike(30, 80)} > 0.7 * noise);
  CHECK(double{alike(30, 80)} < 1.4 * noise);
  CHECK(double{apart(30, 80)} > 5 * noise);
}

TEST_CASE("A stroke that neighbours have where the images agree comes back, and only there",
          "[sketch][steady]") {
  const cv::Mat1f here = frame_of(0, 60, 1), gone = frame_of(0, 0, 2);
  const AttributeGraph full = sketch::extract(here, kOptions);
  REQUIRE(patches_about(full, 80) >= 12);
  const auto steadied = [&](const cv::Mat1f& frame) {
    std::vector<CarriedSketch> neighbours;
    for (const float moved : {-1.5F, 1.5F, 3.0F, -3.0F}) {
      const cv::Mat1f other = frame_of(double{moved}, 60, static_cast<std::uint64_t>(moved + 20));
      neighbours.push_back(neighbour(frame, other, sketch::extract(other, kOptions), moved));
    }
    return sketch::steady_sketch(frame, without(full, 80), neighbours, kOptions);
  };
  CHECK(patches_about(steadied(here), 80) >= 10);
  CHECK(patches_about(steadied(here), 32) >= patches_about(full, 32) - 1);
  CHECK(patches_about(steadied(gone), 80) == 0);
}

TEST_CASE("A stroke that no neighbour has goes where the images agree, and stays where it is born",
          "[sketch][steady]") {
  const cv::Mat1f here = frame_of(0, 60, 1);
  const AttributeGraph full = sketch::extract(here, kOptions);
  for (const bool born : {false, true}) {
    std::vector<CarriedSketch> neighbours;
    for (const std::uint64_t seed : {11U, 12U, 13U, 14U}) {
      const cv::Mat1f other = frame_of(0, born ? 0 : 60, seed);
      neighbours.push_back(neighbour(here, other, without(sketch::extract(other, kOptions), 80), 0));
    }
    const AttributeGraph steadied = sketch::steady_sketch(here, full, neighbours, kOptions);
    CHECK((patches_about(steadied, 80) > 10) == born);
    CHECK(patches_about(steadied, 32) >= patches_about(full, 32) - 1);
  }
}

TEST_CASE("Without neighbours a sketch stays as it is", "[sketch][steady]") {
  const cv::Mat1f here = frame_of(0, 60, 1);
  const AttributeGraph full = sketch::extract(here, kOptions);
  CHECK(sketch::steady_sketch(here, full, {}, kOptions) == full);
}
