// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/coincidence.hpp"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;
using graph::PatchType;

namespace {

graph::Patch placed(double x, double y, double theta, PatchType type = PatchType::ridge) {
  auto patch = test::vertex(0, x, y, theta).patch;
  patch.type = type;
  return patch;
}

}  // namespace

TEST_CASE("Patches of one line coincide within 4.5 px along it, 3 px across and 0.6 rad",
          "[graph][coincidence]") {
  for (const double theta : {0.0, 0.7, 2.5, -1.2}) {
    const auto patch = placed(50, 40, theta);
    const auto off = [&](double along, double across, double turned = 0) {
      return graph::coincidence(
          patch, placed(50 + along * std::cos(theta) - across * std::sin(theta),
                        40 + along * std::sin(theta) + across * std::cos(theta), theta + turned));
    };
    CAPTURE(theta);
    for (const auto& [along, across] : {std::pair(4.4, 0.0), {-4.4, 1.0}, {1.0, 2.9}, {0.5, -2.9}}) {
      const auto apart = off(along, across);
      REQUIRE(apart);
      CHECK_THAT(*apart, test::WithinAbs(std::abs(along) + std::abs(across), 1e-9));
    }
    CHECK(!off(4.6, 0));
    CHECK(!off(-4.6, 0));
    CHECK(!off(0, 3.1));
    CHECK(!off(0, -3.1));
    CHECK(off(1, 1, 0.59));
    CHECK(!off(1, 1, -0.61));
    CHECK(off(1, 1, std::numbers::pi - 0.59));
  }
  CHECK(!graph::coincidence(placed(0, 0, 0), test::vertex(0, 0, 0, 0, -40).patch));
}

TEST_CASE("Corners and junctions coincide within 4.5 px with whatever lies there", "[graph][coincidence]") {
  for (const auto type : {PatchType::corner, PatchType::l_junction, PatchType::t_junction,
                          PatchType::y_junction, PatchType::crossing}) {
    const auto meeting = placed(50, 40, 0, type), there = test::vertex(0, 53, 43, 1.5, -40).patch,
               beyond = test::vertex(0, 53.5, 43, 1.5, -40).patch;
    CHECK_THAT(graph::coincidence(meeting, there).value_or(-1), test::WithinAbs(std::sqrt(18.0), 1e-9));
    CHECK_THAT(graph::coincidence(there, meeting).value_or(-1), test::WithinAbs(std::sqrt(18.0), 1e-9));
    CHECK(!graph::coincidence(meeting, beyond));
  }
}

TEST_CASE("Of several patches that coincide the nearest is found, along and across together",
          "[graph][coincidence]") {
  test::Frame frame;
  frame.vertices = {test::vertex(0, 53, 42.5), test::vertex(1, 54, 40), test::vertex(2, 50.5, 42.9),
                    test::vertex(3, 50, 40, 0, -40)};
  const auto graph = frame.graph();
  const graph::CoincidenceIndex index(graph);
  CHECK(index.find(placed(50, 40, 0)) == 2U);
  CHECK(index.find(placed(51, 40, 0)) == 1U);
  CHECK(!index.find(placed(90, 40, 0)));
  CHECK(index.find_near({50, 40}) == std::vector<std::uint32_t>{0, 1, 2, 3});
}

TEST_CASE("A grid finds the points within its radius, those just at it too, and no others",
          "[graph][coincidence]") {
  core::Rng rng(2);
  for (const double radius : {0.7, 3.0, 25.0}) {
    std::vector<graph::Point> points;
    for (int i = 0; i < 300; ++i)
      points.push_back({std::round(rng.uniform(-40, 40)), std::round(rng.uniform(-40, 40))});
    const graph::detail::PointGrid grid(points, radius);
    for (const auto& centre : points) {
      std::vector<std::uint32_t> near;
      for (std::uint32_t i = 0; i < points.size(); ++i)
        if (graph::dot(points[i] - centre, points[i] - centre) <= radius * radius) near.push_back(i);
      if (grid.find_near(centre) != near) CHECK(grid.find_near(centre) == near);
    }
  }
}
