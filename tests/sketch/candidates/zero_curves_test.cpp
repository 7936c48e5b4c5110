// SPDX-License-Identifier: Apache-2.0
#include "sketch/candidates/zero_curves.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;
using sketch::Chain;

namespace {

constexpr double kSteep = 1;  // grey level per px

std::vector<Chain> edges_of(const cv::Mat1f& frame, double sigma = 1.2) {
  return sketch::trace_edges(sketch::scale_space(frame, sigma, 1)[0], 0, kSteep);
}

cv::Mat1f disc(cv::Size size, Point centre, double radius, double blur) {
  return draw(size, [=](Point p) { return 60 + 100 * reached(radius - graph::distance(p, centre), blur); });
}

}  // namespace

TEST_CASE("The outline of a disc is one closed curve on its circle, with the bright side on the right") {
  const Point centre{30.3, 28.6};
  for (const double radius : {6.0, 12.0, 20.0}) {
    const auto edges = edges_of(disc({64, 60}, centre, radius, 1));
    REQUIRE(edges.size() == 1);
    CHECK(edges[0].closed);
    CHECK(edges[0].kind == sketch::CreaseKind::step);
    for (const sketch::CreasePoint& p : edges[0].points) {
      // Smoothing moves the edge of a disc inwards by (σ² + blur²) / 2r (Berzins 1984).
      CHECK_THAT(graph::distance(p.position, centre),
                 WithinAbs(radius, 0.05 + (1.2 * 1.2 + 1) / (2 * radius)));
      const Point right{-std::sin(p.theta), std::cos(p.theta)};
      CHECK(graph::dot(right, centre - p.position) > 0.95 * radius);
    }
    const Point first = edges[0].points[0].position, next = edges[0].points[1].position,
                right{-(next - first).y, (next - first).x};
    CHECK(graph::dot(right, centre - first) > 0);  // of the way along the curve, too
  }
}

TEST_CASE("Neighbouring points of an edge are less than a pixel's diagonal apart") {
  const auto edges = edges_of(disc({64, 60}, {30, 28}, 15, 1));
  REQUIRE(edges.size() == 1);
  const auto& points = edges[0].points;
  for (std::size_t i = 0; i < points.size(); ++i)
    CHECK(graph::distance(points[i].position, points[(i + 1) % points.size()].position) < 1.5);
}

TEST_CASE("An edge that leaves the frame ends at its border") {
  const auto edges =
      edges_of(draw({50, 40}, [](Point p) { return 60 + 80 * reached(p.x + 0.3 * p.y - 27, 1.5); }));
  REQUIRE(edges.size() == 1);
  CHECK_FALSE(edges[0].closed);
  auto [first, last] = std::minmax(edges[0].points.front().position.y, edges[0].points.back().position.y);
  CHECK(first < 1);
  CHECK(last > 38);
}

TEST_CASE("A line has two edges, and the valley of its slope is none") {
  const auto edges = edges_of(draw({60, 40}, {segment({-20, 20}, {80, 20}, 6, 1)}, 60, 90));
  REQUIRE(edges.size() == 2);
  for (const Chain& edge : edges)
    for (const auto& p : edge.points) CHECK_THAT(std::abs(p.position.y - 20), WithinAbs(3, 0.15));
}

TEST_CASE("The contrast is that of a step of the scale's blur") {
  const double sigma = 1.7;
  const auto edges =
      edges_of(draw({60, 40}, [&](Point p) { return 50 + 70 * reached(p.x - 30.2, sigma); }), sigma);
  REQUIRE(edges.size() == 1);
  for (const auto& p : edges[0].points) CHECK_THAT(p.contrast, WithinRel(70.0, 0.05));
}

TEST_CASE("Where the gradient is below the limit there is no edge") {
  const auto frame = disc({64, 60}, {30, 28}, 15, 1);
  const auto level = sketch::scale_space(frame, 1.2, 1)[0];
  CHECK(sketch::trace_edges(level, 0, 200).empty());
  CHECK(sketch::trace_edges(sketch::scale_space(cv::Mat1f(20, 20, 80.0F), 1.2, 1)[0], 0, 0.01).empty());
}
