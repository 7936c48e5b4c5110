// SPDX-License-Identifier: Apache-2.0
#include "graph/curves/curve_strokes.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;
using graph::Event;
using graph::EventType;

namespace {

using Names = std::vector<graph::SubgraphId>;

/// A frame with curve 1 from left to right and curve 2 above its middle, downwards; `crosses`: beyond it,
/// too.
test::Frame two_curves(bool crosses) {
  test::Frame frame;
  frame.line(test::segment({100, 100}, {160, 100}, 11));  // 0 to 10, 5 in the middle
  frame.line(
      test::segment({130, 70}, {130, crosses ? 124.0 : 94.0}, crosses ? 10 : 5));  // 11 to 15, or to 20
  for (auto& v : frame.vertices) v.curve.value = v.id.value < 11 ? 1 : 2;
  return frame;
}

/// Twice the same frame: an event between them looks at one of the two.
graph::MotionGraph twice(const test::Frame& frame) {
  return test::motion({frame.graph(), frame.graph()}, {{}});
}

Event event(EventType type, Names before, Names after) {
  return {.frame = 1, .type = type, .position = {}, .probability = 1, .before = before, .after = after};
}

}  // namespace

TEST_CASE("A branch that touches another curve with its end is neither born nor dies", "[graph][curves]") {
  auto touching = two_curves(false);
  touching.edge(5, 15);
  for (const auto& [frame, is_branch] : {std::pair{two_curves(false), false}, {touching, true}}) {
    CHECK(graph::changes_names_alone(twice(frame), event(EventType::birth, {}, {{2}})) == is_branch);
    CHECK(graph::changes_names_alone(twice(frame), event(EventType::death, {{2}}, {})) == is_branch);
  }
  // the curve that carries the branch has its ends free
  CHECK_FALSE(graph::changes_names_alone(twice(touching), event(EventType::birth, {}, {{1}})));
  auto crossing = two_curves(true);
  crossing.edge(5, 16);
  CHECK_FALSE(graph::changes_names_alone(twice(crossing), event(EventType::birth, {}, {{2}})));
}

TEST_CASE("Curves that touch before they are one, or still when they are two, change names alone",
          "[graph][curves]") {
  const auto apart = two_curves(false);
  auto touching = apart;
  touching.edge(5, 15);
  const auto merge = event(EventType::merge, {{1}, {2}}, {{1}}),
             split = event(EventType::split, {{1}}, {{1}, {2}});
  const auto was_touching = test::motion({touching.graph(), apart.graph()}, {{}});
  CHECK(graph::changes_names_alone(was_touching, merge));
  CHECK_FALSE(graph::changes_names_alone(was_touching, split));
  const auto is_touching = test::motion({apart.graph(), touching.graph()}, {{}});
  CHECK_FALSE(graph::changes_names_alone(is_touching, merge));
  CHECK(graph::changes_names_alone(is_touching, split));
  // a third curve, and one and the same
  CHECK_FALSE(graph::changes_names_alone(was_touching, event(EventType::merge, {{1}, {3}}, {{1}})));
  CHECK_FALSE(graph::changes_names_alone(was_touching, event(EventType::connect, {{1}, {1}}, {{1}})));
}
