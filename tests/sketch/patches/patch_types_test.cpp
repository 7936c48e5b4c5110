// SPDX-License-Identifier: Apache-2.0
#include "sketch/patches/patch_types.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/catch.hpp"

using namespace emberfold;

namespace {

/// The type of a patch whose edges run in these directions, degrees, all turned by so many more.
std::string type_of_star(const std::vector<double>& arms, double turned, graph::Patch patch = {}) {
  patch.position = {50, 50};
  std::vector<graph::Vertex> vertices{{{0}, {}, patch}};
  std::vector<graph::Edge> edges;
  for (const double degrees : arms) {
    const double angle = (degrees + turned) * std::numbers::pi / 180;
    const graph::VertexId id{static_cast<std::uint32_t>(vertices.size())};
    graph::Patch tip;
    tip.position = patch.position + graph::Point{std::cos(angle), std::sin(angle)} * 6;
    vertices.push_back({id, {}, tip});
    edges.push_back({{0}, id});
  }
  const auto named = sketch::name_patch_types(std::move(vertices), std::move(edges));
  return std::string(graph::name(named.patch(0).type));
}

graph::Patch profile(double width, double blur, double contrast) {
  graph::Patch patch;
  patch.width = width, patch.blur = blur, patch.contrast = contrast;
  return patch;
}

}  // namespace

TEST_CASE("A patch is named by the angles between its edges, however all of them are turned") {
  const auto line = profile(1, 1, 40);
  for (const double turned : {0.0, 37.0, 95.0, 178.0, 251.0, 333.0}) {
    CAPTURE(turned);
    CHECK(type_of_star({0}, turned, line) == "terminator");
    CHECK(type_of_star({0, 125}, turned, line) == "ridge");
    CHECK(type_of_star({0, 115}, turned, line) == "corner");
    CHECK(type_of_star({0, 245}, turned, line) == "corner");
    CHECK(type_of_star({0, 90, 155}, turned, line) == "t_junction");
    CHECK(type_of_star({0, 90, 200}, turned, line) == "t_junction");
    CHECK(type_of_star({0, 70, 145}, turned, line) == "l_junction");
    CHECK(type_of_star({0, 30, 60}, turned, line) == "l_junction");
    CHECK(type_of_star({0, 110, 225}, turned, line) == "y_junction");
    CHECK(type_of_star({0, 120, 240}, turned, line) == "y_junction");
    CHECK(type_of_star({0, 20, 40, 60}, turned, line) == "crossing");
  }
}

TEST_CASE("A patch without edges, or on a smooth curve, is named by its profile") {
  for (const std::vector<double>& arms : {std::vector<double>{}, std::vector<double>{10, 190}}) {
    CHECK(type_of_star(arms, 0, profile(2.9, 1, 40)) == "ridge");
    CHECK(type_of_star(arms, 0, profile(2.9, 1, -40)) == "valley");
    CHECK(type_of_star(arms, 0, profile(3.1, 1, -40)) == "bar");
    CHECK(type_of_star(arms, 0, profile(0, 1, 40)) == "step");
  }
}
