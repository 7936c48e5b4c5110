// SPDX-License-Identifier: Apache-2.0
#include "graph/curves/frame_arcs.hpp"

#include <algorithm>

#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;
using graph::detail::FrameArcs;
using graph::detail::kNoIndex;

TEST_CASE("Every patch lies in one arc or one knot, and arms are ends of arcs", "[graph][curves]") {
  core::Rng rng(5);
  for (int k = 0; k < 200; ++k) {
    const auto graph = test::random_graph(rng, rng.below(8), rng.below(8));
    const FrameArcs arcs(graph);
    std::vector<int> seen(graph.size(), 0);
    for (std::uint32_t a = 0; a < arcs.arcs.size(); ++a) {
      REQUIRE(!arcs.arcs[a].path.empty());
      for (std::uint32_t i = 0; i < arcs.arcs[a].path.size(); ++i) {
        const std::uint32_t v = arcs.arcs[a].path[i];
        ++seen[v];
        CHECK((arcs.arc_of[v] == a && arcs.index_of[v] == i && arcs.knot_of[v] == kNoIndex));
        CHECK(graph.degree(v) <= 2);
      }
    }
    std::size_t ends = 0;
    for (std::uint32_t knot = 0; knot < arcs.knots.size(); ++knot) {
      for (const std::uint32_t v : arcs.knots[knot].vertices) {
        ++seen[v];
        CHECK(arcs.knot_of[v] == knot);
      }
      for (const auto& arm : arcs.knots[knot].arms) {
        const auto& arc = arcs.arcs[arm.arc];
        CHECK((arm.front ? arc.front_knot : arc.back_knot) == knot);
      }
      ends += arcs.knots[knot].arms.size();
    }
    for (const int times : seen) CHECK(times == 1);
    for (const auto& arc : arcs.arcs) {
      ends -= arc.front_knot != kNoIndex ? 1 : 0;
      ends -= arc.back_knot != kNoIndex ? 1 : 0;
    }
    CHECK(ends == 0);
  }
}

TEST_CASE("Two junctions side by side are one knot of four arms", "[graph][curves]") {
  test::Frame frame;
  const auto bar = frame.line(test::segment({100, 100}, {160, 100}, 11));
  const auto up = frame.line(test::segment({124, 60}, {124, 94}, 6));
  const auto down = frame.line(test::segment({130, 106}, {130, 140}, 6));
  frame.edge(bar + 4, up + 5);
  frame.edge(bar + 5, down);
  const auto graph = frame.graph();
  const FrameArcs arcs(graph);
  REQUIRE(arcs.knots.size() == 1);
  CHECK(arcs.knots[0].arms.size() == 4);
  CHECK(arcs.knots[0].vertices.size() == 2);
  CHECK(arcs.arcs.size() == 4);
}

TEST_CASE("Junctions up to 15 px apart are one knot of at most six arms", "[graph][curves]") {
  // Junctions in a row, the arc between two of them has a patch in its middle; each has two arms of its own.
  const auto row = [](int junctions, double apart) {
    test::Frame frame;
    std::uint32_t before = 0;
    for (int k = 0; k < junctions; ++k) {
      const graph::Point at{50 + apart * k, 100};
      const auto middle = frame.line({at});
      for (const double way : {-1.0, 1.0})
        frame.edge(middle, frame.line({at + graph::Point{0, 6 * way}, at + graph::Point{0, 12 * way}}));
      if (k > 0) {
        const auto between = frame.line({at - graph::Point{apart / 2, 0}});
        frame.edge(before, between);
        frame.edge(between, middle);
      }
      before = middle;
    }
    std::vector<std::size_t> arms;
    const auto graph = frame.graph();
    for (const auto& knot : FrameArcs(graph).knots) arms.push_back(knot.arms.size());
    std::sort(arms.begin(), arms.end());
    return arms;
  };
  using Arms = std::vector<std::size_t>;
  CHECK(row(2, 14) == Arms{4});
  CHECK(row(2, 16) == Arms{3, 3});
  CHECK(row(3, 14) == Arms{6});
  const Arms four = row(4, 14);  // a fourth would make seven or eight arms of them
  CHECK(four.size() > 1);
  CHECK(four.back() <= 6);
}

TEST_CASE("A way ends at a tip, at its reach, or once round a ring", "[graph][curves]") {
  test::Frame frame;
  frame.line(test::segment({0, 0}, {50, 0}, 11));
  const auto ring = frame.line({{100, 100}, {106, 100}, {106, 106}, {100, 106}});
  frame.edge(ring, ring + 3);
  const auto graph = frame.graph();
  const FrameArcs arcs(graph);
  REQUIRE(arcs.arcs.size() == 2);
  CHECK(arcs.arcs[1].closed);
  CHECK(arcs.way(0, 3, true, 12) == std::vector<std::uint32_t>{3, 4, 5, 6});
  CHECK(arcs.way(0, 2, false, 100) == std::vector<std::uint32_t>{2, 1, 0});
  CHECK(arcs.way(1, 1, true, 100).size() == 4);
  CHECK(arcs.near(0, 4, 4));
  CHECK(!arcs.near(0, 5, 4));
  CHECK(!arcs.near(0, ring, 50));
}
