// SPDX-License-Identifier: Apache-2.0
#include "graph/events/kept_identity.hpp"

#include <algorithm>

#include "graph/exporting/stroke_tree.hpp"
#include "graph/io/unit_tables.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;

namespace {

using IndexLinks = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

// Lines of four and of three patches in frames 0, 1, 4 and 5; in frames 2 and 3 a bridge of one patch joins
// them.
graph::MotionGraph touching() {
  test::Frame apart, joined;
  apart.line({{10, 50}, {15, 50}, {20, 50}, {25, 50}});
  apart.line({{35, 50}, {40, 50}, {45, 50}});
  joined.line({{10, 50}, {15, 50}, {20, 50}, {25, 50}, {29, 50}, {35, 50}, {40, 50}, {45, 50}});
  const IndexLinks same = {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}, {5, 5}, {6, 6}},
                   closing = {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 5}, {5, 6}, {6, 7}},
                   opening = {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {5, 4}, {6, 5}, {7, 6}},
                   whole = {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}, {5, 5}, {6, 6}, {7, 7}};
  return graph::identify(test::motion(
      {apart.graph(), apart.graph(), joined.graph(), joined.graph(), apart.graph(), apart.graph()},
      {same, closing, whole, opening, same}));
}

std::vector<std::uint32_t> strokes(const graph::MotionGraph& motion, std::size_t frame) {
  std::vector<std::uint32_t> result;
  for (const auto& vertex : motion.sketch.frames[frame].vertices()) result.push_back(vertex.subgraph.value);
  return result;
}

// The events of touching(), merge and split, with these probabilities.
std::vector<graph::Event> events_of(const graph::MotionGraph& motion, double merge, double split) {
  auto events = graph::stroke_events(motion);
  REQUIRE(events.size() == 2);
  REQUIRE(events[0].type == graph::EventType::merge);
  REQUIRE(events[1].type == graph::EventType::split);
  events[0].probability = merge, events[1].probability = split;
  return events;
}

const std::vector<std::uint32_t> kTwo = {1, 1, 1, 1, 2, 2, 2};

}  // namespace

TEST_CASE("Strokes that only seem to touch keep their identities", "[graph][kept_identity]") {
  auto motion = touching();
  REQUIRE(strokes(motion, 3) == std::vector<std::uint32_t>(8, 3));
  auto events = events_of(motion, 0.49, 0.2);
  graph::keep_identity(motion, events, 0.5);
  for (const std::size_t t : {0, 1, 4, 5}) CHECK(strokes(motion, t) == kTwo);
  // The bridge is nearer to the long one; once it has a name it keeps it.
  for (const std::size_t t : {2, 3})
    CHECK(strokes(motion, t) == std::vector<std::uint32_t>{1, 1, 1, 1, 1, 2, 2, 2});
  CHECK(events[0].before == std::vector<graph::SubgraphId>{{1}, {2}});
  CHECK(events[0].after == std::vector<graph::SubgraphId>{{1}});
  CHECK(events[1].before == std::vector<graph::SubgraphId>{{1}});
  CHECK(events[1].after == std::vector<graph::SubgraphId>{{1}, {2}});
  const auto lives = graph::stroke_lives(motion);
  REQUIRE(lives.size() == 2);
  for (const auto& life : lives) CHECK(life.frames() == 6);
}

TEST_CASE("What a believed union or separation leaves are new strokes", "[graph][kept_identity]") {
  auto motion = touching();
  auto events = events_of(motion, 0.5, 0.9);
  graph::keep_identity(motion, events, 0.5);
  CHECK(strokes(motion, 1) == kTwo);
  CHECK(strokes(motion, 2) == std::vector<std::uint32_t>(8, 3));
  CHECK(strokes(motion, 3) == std::vector<std::uint32_t>(8, 3));
  CHECK(strokes(motion, 4) == std::vector<std::uint32_t>{4, 4, 4, 4, 5, 5, 5});
  CHECK(strokes(motion, 5) == strokes(motion, 4));
  CHECK(events[0].before == std::vector<graph::SubgraphId>{{1}, {2}});
  CHECK(events[0].after == std::vector<graph::SubgraphId>{{3}});
  CHECK(events[1].before == std::vector<graph::SubgraphId>{{3}});
  CHECK(events[1].after == std::vector<graph::SubgraphId>{{4}, {5}});
  // The tree leads from both into the whole, and from there to both.
  const auto tree = graph::make_stroke_tree(motion, events);
  std::vector<std::pair<std::string, std::pair<std::uint32_t, std::uint32_t>>> changes;
  for (const auto& link : tree.links) {
    const auto &from = tree.rows[link.from], &to = tree.rows[link.to];
    CHECK(to.frame == from.frame + 1);
    if (!link.event.empty()) changes.push_back({link.event, {from.stroke, to.stroke}});
  }
  using Change = decltype(changes)::value_type;
  CHECK(changes ==
        std::vector<Change>{{"merge", {1, 3}}, {"merge", {2, 3}}, {"split", {3, 4}}, {"split", {3, 5}}});
}

TEST_CASE("A separation that is not believed leaves one stroke in two pieces", "[graph][kept_identity]") {
  auto motion = touching();
  auto events = events_of(motion, 1, 0.3);
  graph::keep_identity(motion, events, 0.5);
  CHECK(strokes(motion, 5) == std::vector<std::uint32_t>(7, 3));
  for (const auto& row : graph::stroke_rows(motion)) {
    if (row.stroke != 3 || row.frame != 5) continue;
    CHECK(row.pieces == 2);
    CHECK(row.patches == 7);
    CHECK(row.ends == 4);
    CHECK(row.length == Approx(15 + 10));
    CHECK(row.middle.x == Approx(17.5));  // of the longer piece
  }
  const auto rows = graph::stroke_rows(motion);
  CHECK(std::ranges::count_if(rows, [](const auto& row) { return row.frame == 5; }) == 1);
}

TEST_CASE("Pieces of one stroke that a believed union joins are two strokes since they came apart",
          "[graph][kept_identity]") {
  // The line of touching() comes apart in frame 1, which is not believed, and is one again in frame 3.
  const auto frames = touching().sketch.frames;
  const IndexLinks same = {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}, {5, 5}, {6, 6}},
                   opening = {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {5, 4}, {6, 5}, {7, 6}},
                   closing = {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 5}, {5, 6}, {6, 7}};
  auto motion =
      graph::identify(test::motion({frames[2], frames[4], frames[5], frames[2]}, {opening, same, closing}));
  auto events = graph::stroke_events(motion);
  REQUIRE(events.size() == 2);
  events[0].probability = 0.3, events[1].probability = 0.8;  // the separation, the union
  graph::keep_identity(motion, events, 0.5);
  CHECK(strokes(motion, 0) == std::vector<std::uint32_t>(8, 1));
  for (const std::size_t t : {1, 2})
    CHECK(strokes(motion, t) == std::vector<std::uint32_t>{1, 1, 1, 1, 2, 2, 2});
  CHECK(strokes(motion, 3) == std::vector<std::uint32_t>(8, 3));
  CHECK(events[1].before == std::vector<graph::SubgraphId>{{1}, {2}});
  CHECK(events[1].after == std::vector<graph::SubgraphId>{{3}});
}

TEST_CASE("Births that nothing is linked with are new strokes", "[graph][kept_identity]") {
  test::Frame one, two;
  one.line({{10, 10}, {15, 10}, {20, 10}});
  two.line({{10, 10}, {15, 10}, {20, 10}});
  two.line({{60, 60}, {65, 60}});
  auto motion = graph::identify(
      test::motion({one.graph(), two.graph(), one.graph(), two.graph()},
                   {{{0, 0}, {1, 1}, {2, 2}}, {{0, 0}, {1, 1}, {2, 2}}, {{0, 0}, {1, 1}, {2, 2}}}));
  auto events = graph::stroke_events(motion);
  for (auto& event : events) event.probability = 0;
  graph::keep_identity(motion, events, 0.5);
  CHECK(strokes(motion, 1) == std::vector<std::uint32_t>{1, 1, 1, 2, 2});
  CHECK(strokes(motion, 3) == std::vector<std::uint32_t>{1, 1, 1, 3, 3});
}

TEST_CASE("Three strokes that become one at once are one", "[graph][kept_identity]") {
  test::Frame apart, whole;
  for (const double x : {10.0, 40.0, 70.0}) apart.line({{x, 50}, {x + 5, 50}, {x + 10, 50}});
  whole.line({{10, 50},
              {15, 50},
              {20, 50},
              {30, 50},
              {40, 50},
              {45, 50},
              {50, 50},
              {60, 50},
              {70, 50},
              {75, 50},
              {80, 50}});
  auto motion = graph::identify(
      test::motion({apart.graph(), whole.graph()},
                   {{{0, 0}, {1, 1}, {2, 2}, {3, 4}, {4, 5}, {5, 6}, {6, 8}, {7, 9}, {8, 10}}}));
  auto events = graph::stroke_events(motion);
  REQUIRE(events.size() == 2);
  graph::keep_identity(motion, events, 0.5);
  for (const auto stroke : strokes(motion, 1)) CHECK(stroke == strokes(motion, 1)[0]);
  CHECK(strokes(motion, 1)[0] > 3);
}
