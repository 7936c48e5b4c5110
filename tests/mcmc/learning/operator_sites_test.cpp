// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/operator_sites.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "graph/events/events.hpp"
#include "mcmc/simulation/linked_frames.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;
using Pairs = std::vector<mcmc::OperatorSites::Pair>;
using Vertices = std::vector<std::uint32_t>;

namespace {

mcmc::OperatorSites find_sites(const test::Frame& frame, double reach = 24) {
  const auto graph = frame.graph();
  return mcmc::find_sites(graph, graph::components(graph), reach);
}

}  // namespace

TEST_CASE("A straight stroke can split where both pieces are strokes", "[sites]") {
  for (const int patches : {1, 2, 5, 8, 9, 10, 14}) {
    test::Frame frame;
    frame.line(test::segment({20, 20}, {20 + 5.0 * (patches - 1), 20}, patches));
    const auto found = find_sites(frame);
    // A removed patch leaves pieces of at least 4 patches on both sides: 4, 5, … , n − 5.
    Vertices inner;
    for (int v = 4; v <= patches - 5; ++v) inner.push_back(static_cast<std::uint32_t>(v));
    CHECK(found.split_sites == inner);
    CHECK(found.disconnect_sites.empty());
    CHECK(found.merge_sites.empty());
    CHECK(found.connect_sites.empty());
  }
}

TEST_CASE("A ring can split everywhere", "[sites]") {
  test::Frame frame;
  std::vector<graph::Point> points;
  for (int k = 0; k < 50; ++k)
    points.push_back(
        {100 + 40 * std::cos(k * std::numbers::pi / 25), 100 + 40 * std::sin(k * std::numbers::pi / 25)});
  frame.line(points);
  frame.edge(0, 49);
  const auto found = find_sites(frame);
  // Its first patch is where the curve begins and ends.
  REQUIRE(found.split_sites.size() >= 49);
  Vertices expected;
  for (std::uint32_t v = found.split_sites.front(); v < 50; ++v) expected.push_back(v);
  CHECK(found.split_sites == expected);
  CHECK(found.disconnect_sites.empty());
}

TEST_CASE("A T can come apart at each arm that is long enough", "[sites]") {
  test::Frame frame;
  frame.line(test::segment({0, 50}, {60, 50}, 13));  // 0 … 12
  frame.line(test::segment({30, 55}, {30, 80}, 6));  // 13 … 18
  frame.edge(6, 13);
  SECTION("all arms") {
    const auto found = find_sites(frame);
    CHECK(found.disconnect_sites == Pairs{{6, 5}, {6, 7}, {6, 13}});
    // Towards the junction a piece may be as short as it likes: it stays with the others.
    CHECK(found.split_sites == Vertices{4, 5, 7, 8, 13, 14});
  }
  SECTION("one arm of fewer patches than a stroke") {
    test::Frame other;
    other.line(test::segment({0, 50}, {60, 50}, 13));
    other.line(test::segment({30, 55}, {30, 65}, 3));
    other.edge(6, 13);
    const auto found = find_sites(other);
    CHECK(found.disconnect_sites == Pairs{{6, 5}, {6, 7}});
    CHECK(found.split_sites == Vertices{4, 5, 7, 8});
  }
}

TEST_CASE("A corner can come apart on both sides and is no place to split", "[sites]") {
  test::Frame frame;
  auto points = test::segment({20, 20}, {50, 20}, 7);
  for (const auto p : test::segment({50, 25}, {50, 50}, 6)) points.push_back(p);
  frame.line(points);  // the corner is 6 of 0 … 12
  const auto found = find_sites(frame);
  CHECK(found.disconnect_sites == Pairs{{6, 5}, {6, 7}});
  CHECK(found.split_sites.empty());  // with the corner so near, it would be read as a disconnect
  SECTION("near a free end it cannot") {
    test::Frame hook;
    auto bent = test::segment({20, 20}, {60, 20}, 9);
    bent.insert(bent.end(), {{60, 25}, {60, 30}});
    hook.line(bent);  // the corner is 8 of 0 … 10
    CHECK(find_sites(hook).disconnect_sites.empty());
    CHECK(find_sites(hook).split_sites == Vertices{4});
  }
}

TEST_CASE("A turn of less than 30 degrees is no corner and one of more is", "[sites]") {
  for (const auto& [degrees, is_corner] : {std::pair{25.0, false}, {35.0, true}}) {
    test::Frame frame;
    auto points = test::segment({20, 20}, {50, 20}, 7);
    const double angle = degrees * std::numbers::pi / 180;
    for (int k = 1; k <= 6; ++k)
      points.push_back(graph::Point{50, 20} + graph::Point{std::cos(angle), std::sin(angle)} * (5.0 * k));
    frame.line(points);
    const auto inner = find_sites(frame).split_sites;
    CHECK(std::ranges::count(inner, 6U) == (is_corner ? 0 : 1));
    CHECK(find_sites(frame).disconnect_sites.size() == (is_corner ? 2 : 0));
  }
}

TEST_CASE("A curve without a patch where it can split is read as split", "[sites]") {
  for (const double height : {0.0, 4.0, 8.0, 14.0}) {
    std::vector<graph::Point> points;
    for (int k = 0; k < 40; ++k) points.push_back({20 + 4.5 * k, 100 + height * std::sin(0.35 * k)});
    test::Frame frame;
    frame.line(points);
    const auto whole = frame.graph();
    const auto inner = find_sites(frame).split_sites;
    REQUIRE(inner.size() >= 3);
    for (const auto v : inner) {
      std::vector<graph::Vertex> vertices;
      std::vector<graph::Edge> edges;
      for (const auto& vertex : whole.vertices())
        if (vertex.id != whole.vertices()[v].id) vertices.push_back(vertex);
      for (const auto& edge : whole.edges())
        if (edge.a != whole.vertices()[v].id && edge.b != whole.vertices()[v].id) edges.push_back(edge);
      mcmc::detail::LinkedFrames linked;
      linked.motion.sketch.width = 320, linked.motion.sketch.height = 240;
      linked.append(whole);
      linked.append(graph::AttributeGraph(vertices, edges));
      const auto events = graph::stroke_events(graph::identify(linked.motion));
      INFO("height " << height << ", patch " << v);
      REQUIRE(events.size() == 1);
      CHECK(events[0].type == graph::EventType::split);
    }
  }
}

TEST_CASE("Two ends in line can merge and in no line connect", "[sites]") {
  test::Frame frame;
  frame.line(test::segment({20, 20}, {60, 20}, 9));  // 0 … 8
  SECTION("in line") {
    frame.line(test::segment({75, 20}, {115, 20}, 9));
    const auto found = find_sites(frame);
    CHECK(found.merge_sites == Pairs{{8, 9}});
    CHECK(found.connect_sites.empty());
  }
  SECTION("in line, but out of reach") {
    frame.line(test::segment({75, 20}, {115, 20}, 9));
    CHECK(find_sites(frame, 14.9).merge_sites.empty());
    CHECK(find_sites(frame, 15.1).merge_sites.size() == 1);
  }
  SECTION("in line, of other sign") {
    frame.line(test::segment({75, 20}, {115, 20}, 9), -40);
    const auto found = find_sites(frame);
    CHECK(found.merge_sites.empty());
    CHECK(found.connect_sites.empty());
  }
  SECTION("shifted aside by more than a turn of 30 degrees") {
    frame.line(test::segment({70, 32}, {110, 32}, 9));  // 50 degrees
    const auto found = find_sites(frame);
    CHECK(found.merge_sites.empty());
    // Each end to the other's: one site for two strokes.
    CHECK(found.connect_sites == Pairs{{8, 9}});
  }
  SECTION("at right angles") {
    frame.line(test::segment({70, 20}, {70, 60}, 9));
    CHECK(find_sites(frame).merge_sites.empty());
    CHECK(find_sites(frame).connect_sites == Pairs{{8, 9}});
  }
}

TEST_CASE("An end beside a line can connect with its nearest patch", "[sites]") {
  test::Frame frame;
  frame.line(test::segment({20, 50}, {100, 50}, 17));  // 0 … 16; 8 at x = 60
  frame.line(test::segment({61, 60}, {61, 90}, 7));    // 17 … 23
  const auto found = find_sites(frame);
  CHECK(found.connect_sites == Pairs{{17, 8}});
  CHECK(found.merge_sites.empty());
  CHECK(find_sites(frame, 8).connect_sites.empty());
}

TEST_CASE("Two strokes are one site, where they come nearest and in line first", "[sites]") {
  test::Frame frame;
  // A horseshoe about a straight stroke: both ends of it come near, and the stroke's own end faces one side.
  frame.line(test::segment({20, 20}, {60, 20}, 9));  // 0 … 8
  // A stroke that begins in line with the first, 20 px on, and whose other end turns back to within 10 px.
  auto points = test::segment({80, 20}, {120, 20}, 9);  // 9 … 17
  for (const auto p : test::segment({120, 25}, {120, 35}, 3)) points.push_back(p);
  for (const auto p : test::segment({115, 35}, {60, 30}, 12)) points.push_back(p);
  frame.line(points);
  const auto found = find_sites(frame);
  CHECK(found.merge_sites == Pairs{{8, 9}});
  CHECK(found.connect_sites.empty());
}

TEST_CASE("Three ends about a place are three sites of pairs", "[sites]") {
  test::Frame frame;
  for (const double degrees : {0, 90, 200}) {
    const double angle = degrees * std::numbers::pi / 180;
    const graph::Point out{std::cos(angle), std::sin(angle)};
    frame.line(test::segment(graph::Point{100, 100} + out * 6, graph::Point{100, 100} + out * 46, 9));
  }
  const auto found = find_sites(frame);
  // Between the first and the last the line turns by 10 degrees, else by 45 and 35.
  CHECK(found.merge_sites == Pairs{{0, 18}});
  CHECK(found.connect_sites == Pairs{{0, 9}, {9, 18}});
}

TEST_CASE("A stroke alone, a patch alone and nothing have no sites between", "[sites]") {
  test::Frame frame;
  CHECK(find_sites(frame).split_sites.empty());
  frame.line({{50, 50}});
  // A patch has no end that points anywhere; another's end can reach it.
  frame.line(test::segment({56, 50}, {96, 50}, 9));  // 1 … 9
  CHECK(find_sites(frame).merge_sites.empty());
  CHECK(find_sites(frame).connect_sites == Pairs{{1, 0}});
}
