// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/event_strokes.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;

namespace {

using IndexLinks = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
using Strokes = std::vector<graph::SubgraphId>;

/// A line of six patches and, 50 px below it, one of three; in the second frame the first one has a gap if it
/// `parts`, and the other one is there only if it is `seen`.
graph::MotionGraph reading(bool parts, bool seen) {
  test::Frame before, after;
  before.line(test::segment({100, 20}, {125, 20}, 6));
  if (parts) {
    after.line(test::segment({100, 20}, {110, 20}, 3));
    after.line(test::segment({115, 20}, {125, 20}, 3));
  } else {
    after.line(test::segment({100, 20}, {125, 20}, 6));
  }
  if (seen) after.line(test::segment({100, 70}, {110, 70}, 3));
  const IndexLinks links = {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}, {5, 5}};
  return graph::identify(test::motion({before.graph(), after.graph()}, {links}));
}

graph::Event named(graph::Event event, const graph::MotionGraph& from, const graph::MotionGraph& to) {
  pipeline::name_strokes(event, pipeline::MotionIndex(from), pipeline::MotionIndex(to));
  return event;
}

}  // namespace

TEST_CASE("An event of another reading names the strokes of the first one", "[posterior]") {
  const auto other = reading(true, true);
  const auto events = graph::stroke_events(other);
  REQUIRE(events.size() == 2);
  REQUIRE(events[0].type == graph::EventType::birth);
  REQUIRE(events[1].type == graph::EventType::split);

  // The other reading calls the halves 2 and 3, what is born 4; of the first one that is 2.
  const auto first = reading(false, true);
  CHECK(named(events[0], other, first).before.empty());
  CHECK(named(events[0], other, first).after == Strokes{{2}});
  CHECK(named(events[1], other, first).before == Strokes{{1}});
  CHECK(named(events[1], other, first).after == Strokes{{1}});

  // A reading that has both halves, and not the birth.
  const auto same = reading(true, false);
  CHECK(named(events[1], other, same).after == Strokes{{2}, {3}});
  CHECK(named(events[0], other, same).after.empty());
}
