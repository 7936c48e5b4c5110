// SPDX-License-Identifier: Apache-2.0
#include "sketch/refinement/pursuit.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "sketch/extract.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/patches/blob.hpp"
#include "sketch/patches/blob_shape.hpp"
#include "sketch/rendering/render.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::sketch;
using namespace emberfold::test;

namespace {

const cv::Size kPursuitSize(160, 120);

std::size_t count_blobs(const graph::AttributeGraph& graph) {
  return static_cast<std::size_t>(std::ranges::count_if(
      graph.vertices(), [](const auto& v) { return v.patch.type == graph::PatchType::blob; }));
}

double squared_error(const graph::AttributeGraph& graph, const cv::Mat1f& frame) {
  const Sketchable part = draw_fitted(graph, frame.size(), 1);
  const double off = cv::norm(fill(part.levels, part.mask).levels, frame);
  return off * off;
}

/// Strokes and dots on a slow ramp.
cv::Mat1f busy_frame() {
  return draw(kPursuitSize, [](Point p) {
    double level = 60 + 0.3 * p.x;
    level += 80 * segment({20, 30}, {140, 50}, 4, 1)(p) - 40 * segment({30, 100}, {60, 60}, 5, 1.5)(p);
    for (const Point dot : {Point{100, 80}, Point{120, 95}, Point{80, 100}})
      level += 90 * std::exp(-0.5 * graph::dot(p - dot, p - dot) / 4);
    return level;
  });
}

}  // namespace

TEST_CASE("A blob is found again with the levels it was drawn with") {
  graph::Patch blob;
  blob.type = graph::PatchType::blob;
  blob.position = {40, 30};
  blob.width = 4, blob.blur = 2;
  blob.theta = 0.7;
  blob.left = {50, 60, 70}, blob.middle = {160, 150, 140}, blob.right = {90, 100, 110};
  const graph::AttributeGraph one({{{0}, {}, blob}}, {});
  const Sketchable drawn = draw_fitted(one, {80, 60}, 3);
  const graph::Patch found = fit_blob(drawn.levels, {40, 30}, BlobShape(blob).reach());
  CHECK_THAT(found.theta, WithinAbs(blob.theta, 1e-3));
  CHECK_THAT(found.width, WithinAbs(blob.width, 1e-9));
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK_THAT(found.left[c], WithinAbs(blob.left[c], 0.05));
    CHECK_THAT(found.middle[c], WithinAbs(blob.middle[c], 0.05));
    CHECK_THAT(found.right[c], WithinAbs(blob.right[c], 0.05));
  }
  // A disc of 6 px, nothing else, from its attributes and from pixels.
  CHECK(cv::countNonZero(drawn.mask) == 113);
  CHECK(cv::countNonZero(draw_pixels(one, drawn.levels).mask != drawn.mask) == 0);
}

TEST_CASE("Dots become blobs under a budget and strokes stay strokes") {
  const cv::Mat1f frame = with_noise(busy_frame(), 2, 1);
  ExtractOptions options;
  CHECK(count_blobs(extract(frame, options)) == 0);
  options.budget = 1;
  const graph::AttributeGraph found = extract(frame, options);
  for (const Point dot : {Point{100, 80}, Point{120, 95}, Point{80, 100}})
    CHECK(std::ranges::any_of(found.vertices(), [&](const auto& v) {
      return v.patch.type == graph::PatchType::blob && graph::distance(v.patch.position, dot) < 2.5;
    }));
  CHECK(std::ranges::any_of(found.vertices(), [](const auto& v) {
    return v.patch.contrast > 50 && v.patch.type != graph::PatchType::blob &&
           std::abs(v.patch.position.y - 40) < 8;
  }));
}

TEST_CASE("Nothing pays on even ground and hardly anything in noise") {
  ExtractOptions options;
  options.budget = 1;
  CHECK(extract(cv::Mat1f(kPursuitSize, 90.0F), options).empty());
  std::size_t blobs = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed)
    blobs += count_blobs(extract(with_noise(cv::Mat1f(cv::Size(256, 256), 90.0F), 8, seed), options));
  CHECK(blobs <= 5);
}

TEST_CASE("A budget is kept, and more of it shows more") {
  const cv::Mat1f frame = with_noise(busy_frame(), 2, 2);
  double before = 1e18;
  for (const double budget : {0.01, 0.03, 0.08}) {
    ExtractOptions options;
    options.budget = budget;
    const graph::AttributeGraph sketch = extract(frame, options);
    const double share = draw_pixels(sketch, frame).share();
    CHECK(share <= budget);
    CHECK(share > 0.7 * budget);
    const double error = squared_error(sketch, frame);
    CHECK(error < before);
    before = error;
  }
}

TEST_CASE("What is chosen is part of what was proposed, with its patches untouched") {
  const cv::Mat1f frame = with_noise(busy_frame(), 2, 3);
  const graph::AttributeGraph strokes = extract(frame, {});
  const graph::AttributeGraph chosen = pursue(strokes, frame, {2, 0.1});
  std::size_t kept = 0;
  for (const graph::Vertex& v : chosen.vertices()) {
    if (v.patch.type == graph::PatchType::blob) continue;
    ++kept;
    CHECK(std::ranges::any_of(strokes.vertices(), [&](const auto& s) {
      return s.patch.position == v.patch.position && s.patch.middle == v.patch.middle &&
             s.patch.gain == v.patch.gain;
    }));
  }
  CHECK(kept > 0);
  CHECK(pursue(strokes, frame, {2, 0.1}) == chosen);
}

TEST_CASE("A coloured dot is a blob of its colours") {
  std::vector<cv::Mat> channels;
  for (const double height : {20.0, 60.0, 120.0})
    channels.push_back(draw(kPursuitSize, {ring({80, 60}, 0, 5, 1.5)}, 60, height));
  cv::Mat frame;
  cv::merge(channels, frame);
  ExtractOptions options;
  options.budget = 0.05;
  const graph::AttributeGraph found = extract(frame, options);
  const auto near = std::ranges::find_if(found.vertices(), [](const auto& v) {
    return v.patch.type == graph::PatchType::blob && graph::distance(v.patch.position, {80, 60}) < 2.5;
  });
  REQUIRE(near != found.vertices().end());
  CHECK(near->patch.middle[2] > near->patch.middle[1] + 20);
  CHECK(near->patch.middle[1] > near->patch.middle[0] + 10);
}
