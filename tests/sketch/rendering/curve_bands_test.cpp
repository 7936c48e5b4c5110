// SPDX-License-Identifier: Apache-2.0
#include "sketch/rendering/curve_bands.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;
using namespace emberfold::test;

TEST_CASE("A patch without edges is drawn 2.5 px to both sides, an anchor is no band") {
  for (const double theta : {0.0, 0.9, -2.2}) {
    const auto bands = sketch::make_bands({{vertex(0, 50, 40, theta), anchor(1, 10, 10)}, {}});
    REQUIRE(bands.size() == 1);
    CHECK_THAT(bands[0].length, WithinAbs(5, 1e-12));
    CHECK_THAT(bands[0].origin.x, WithinAbs(50 - 2.5 * std::cos(theta), 1e-12));
    CHECK_THAT(bands[0].origin.y, WithinAbs(40 - 2.5 * std::sin(theta), 1e-12));
    CHECK((!bands[0].a.round && !bands[0].b.round && bands[0].before == 0 && bands[0].after == 0));
  }
}

TEST_CASE("Bands beside anchors are a third as wide, and no narrower without") {
  Frame frame;
  frame.line({{20, 50}, {26, 50}, {32, 50}});
  const auto whole = sketch::make_bands(frame.graph()), cores = sketch::make_bands(frame.graph(), true);
  REQUIRE(cores.size() == whole.size());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    CHECK(whole[i].a.reach == sketch::profile_reach(frame.vertices[0].patch));
    CHECK_THAT(cores[i].a.reach, WithinAbs(0.35 * whole[i].a.reach, 1e-12));
    CHECK_THAT(cores[i].b.reach, WithinAbs(0.35 * whole[i].b.reach, 1e-12));
  }
}

TEST_CASE("What only joins the outlines of a thing is no band") {
  Frame frame;
  frame.line({{20, 50}, {26, 50}, {32, 50}});
  frame.line({{20, 70}, {26, 70}, {32, 70}});
  frame.edge(1, 4);
  for (const double width : {0.0, 2.0}) {
    for (auto& vertex : frame.vertices) vertex.patch.width = width;
    CHECK(sketch::make_bands(frame.graph()).size() == (width > 0 ? 5 : 4));
  }
}

TEST_CASE("Bands are rounded at bends and junctions, not where a curve goes on nor at its tips") {
  Frame frame;
  frame.line({{20, 50}, {26, 50}, {32, 50}, {32, 56}, {32, 62}});  // a right angle at 2
  frame.vertices[2].patch.theta = 0;
  const auto graph = frame.graph();
  const auto bands = sketch::make_bands(graph);
  REQUIRE(bands.size() == 4);
  for (const auto& band : bands) {
    const bool from_corner = band.origin == graph::Point{32, 50};
    const bool to_corner = band.origin == graph::Point{26, 50};
    CHECK(band.a.round == from_corner);
    CHECK(band.b.round == to_corner);
    CHECK(band.before == (band.origin == graph::Point{20, 50} ? 1 : 0));
    CHECK(band.after == (band.origin == graph::Point{32, 56} ? 1 : 0));
    CHECK_THAT(band.length, WithinAbs(6, 1e-12));
  }
}

TEST_CASE("A band follows the directions of its patches, and knows which way they look") {
  Frame frame;
  frame.vertices = {vertex(0, 20, 50, 0.2), vertex(1, 40, 50, -0.3 + std::numbers::pi)};
  frame.edge(0, 1);
  const auto band = sketch::make_bands(frame.graph()).at(0);
  CHECK_THAT(band.a.slope, WithinAbs(std::tan(0.2), 1e-12));
  CHECK_THAT(band.b.slope, WithinAbs(std::tan(-0.3), 1e-12));
  CHECK((!band.a.backwards && band.b.backwards));
  // Its height is the cubic with these slopes, 0 at both ends.
  const auto height = [&](double u) { return sketch::height_at(band, u).value; };
  CHECK_THAT(height(0), WithinAbs(0, 1e-12));
  CHECK_THAT(height(20), WithinAbs(0, 1e-12));
  CHECK_THAT(height(1e-4) / 1e-4, WithinAbs(std::tan(0.2), 1e-3));
  CHECK_THAT(height(20 - 1e-4) / -1e-4, WithinAbs(std::tan(-0.3), 1e-3));
  CHECK_THAT(height(10), WithinAbs(20 * (std::tan(0.2) + std::tan(0.3)) / 8, 1e-9));
  // A patch across its edge has no say: the other's direction and sense are taken.
  frame.vertices[1].patch.theta = std::numbers::pi / 2;
  const auto crossed = sketch::make_bands(frame.graph()).at(0);
  CHECK(crossed.b.slope == 0);
  CHECK((crossed.a.vertex == 0 && crossed.b.vertex == 0 && !crossed.b.backwards));
}
