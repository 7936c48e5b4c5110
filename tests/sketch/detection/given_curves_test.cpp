// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/given_curves.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "sketch/extract.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::AttributeGraph;

namespace {

const cv::Size kGivenCurvesSize{160, 120};

/// A bright line at y = 30, a dark one at y = 60 and a step at y = 90, all so faint that noise hides them.
cv::Mat1f frame() {
  return with_noise(draw(kGivenCurvesSize,
                         [](Point p) {
                           const auto line = [&](double y) {
                             return std::exp(-0.5 * std::pow((p.y - y) / 2, 2));
                           };
                           return 100 + 6 * line(30) - 6 * line(60) + 6 * reached(p.y - 90, 1);
                         }),
                    4, 3);
}

/// Marks of this thickness and probability along the three.
cv::Mat1f marks(int thickness, float probability) {
  cv::Mat1f map(kGivenCurvesSize, 0.02F);
  for (const int y : {30, 60, 90})
    cv::line(map, {15, y}, {145, y}, cv::Scalar(double{probability}), thickness);
  return map;
}

double length_near(const AttributeGraph& graph, double y, double sign, bool step) {
  double length = 0;
  for (const graph::Edge& e : graph.edges()) {
    const graph::Patch &a = graph.patch(graph.index_of(e.a)), &b = graph.patch(graph.index_of(e.b));
    if (std::abs(0.5 * (a.position.y + b.position.y) - y) < 2 && graph::on_step(a) == step &&
        (step || a.contrast * sign > 0))
      length += graph::distance(a.position, b.position);
  }
  return length;
}

}  // namespace

TEST_CASE("Given curves are drawn where they are, as what the frame shows there", "[sketch]") {
  for (const int thickness : {1, 5}) {
    const AttributeGraph graph = sketch::extract(frame(), {}, marks(thickness, 0.9F));
    INFO("thickness " << thickness);
    CHECK(length_near(graph, 30, 1, false) > 90);
    CHECK(length_near(graph, 60, -1, false) > 90);
    CHECK(length_near(graph, 90, 0, true) > 90);
    for (const graph::Vertex& v : graph.vertices()) {
      CHECK(v.patch.evidence > 0);
      CHECK(std::min({std::abs(v.patch.position.y - 30), std::abs(v.patch.position.y - 60),
                      std::abs(v.patch.position.y - 90)}) < 3);
    }
  }
}

TEST_CASE("The sensitivity is the probability at which given curves begin", "[sketch]") {
  const cv::Mat1f half = marks(3, 0.45F);
  CHECK(sketch::extract(frame(), {.sensitivity = 0.5}, half).empty());
  CHECK(length_near(sketch::extract(frame(), {.sensitivity = 0.6}, half), 30, 1, false) > 90);
}

TEST_CASE("Where no curve is given none is drawn, and what is no probability is refused", "[sketch]") {
  const cv::Mat1f clear = draw(kGivenCurvesSize, {segment({20, 60}, {140, 60}, 4, 1)}, 60, 120);
  CHECK_FALSE(sketch::extract(clear, {}).empty());
  CHECK(sketch::extract(clear, {}, cv::Mat1f(kGivenCurvesSize, 0.0F)).empty());
  CHECK_THROWS_AS(sketch::extract(clear, {}, cv::Mat1f(kGivenCurvesSize, 1.5F)), core::InputError);
  CHECK_THROWS_AS(sketch::extract(clear, {}, cv::Mat1f(10, 10, 0.5F)), core::InputError);
}
