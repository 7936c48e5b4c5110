// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/time_reversal.hpp"

#include "core/error.hpp"
#include "graph/matching/match.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

/// Frames of random strokes that shift a little, come and go.
graph::MotionGraph random_motion(std::uint64_t seed) {
  core::Rng rng(seed);
  graph::SketchSequence sketch;
  sketch.width = 320, sketch.height = 240;
  struct Stroke {
    graph::Point from, to;
    int first, last;
    int torn;  // from then on in two
  };
  std::vector<Stroke> strokes;
  for (int k = 0; k < 12; ++k) {
    const graph::Point from{20 + 80.0 * (k % 4), 30 + 80.0 * (k / 4)};
    const int first = static_cast<int>(rng.below(4)), last = 6 + static_cast<int>(rng.below(6));
    strokes.push_back(
        {from, from + graph::Point{40, rng.uniform(-20, 20)}, first, last, static_cast<int>(rng.below(12))});
  }
  for (int t = 0; t < 10; ++t) {
    test::Frame frame;
    for (const Stroke& stroke : strokes) {
      if (t < stroke.first || t > stroke.last) continue;
      const graph::Point shift{rng.uniform(-1, 1) + 0.5 * t, rng.uniform(-1, 1)};
      auto points = test::segment(stroke.from + shift, stroke.to + shift, 10);
      if (t < stroke.torn) {
        frame.line(points);
      } else {
        frame.line({points.begin(), points.begin() + 4});
        frame.line({points.begin() + 6, points.end()});
      }
    }
    sketch.append(frame.graph());
  }
  graph::MatchOptions options;
  options.flicker = 0;
  return graph::match(sketch, options);
}

}  // namespace

TEST_CASE("a motion graph reversed twice is itself") {
  const auto seed = GENERATE(range(0, 5));
  const graph::MotionGraph motion = random_motion(static_cast<std::uint64_t>(seed));
  const graph::MotionGraph back = graph::reverse_time(motion);
  CHECK_NOTHROW(graph::validate(back));
  CHECK(back.sketch == graph::identify(back).sketch);
  CHECK_FALSE(back == motion);
  CHECK(graph::reverse_time(back) == motion);
  CHECK(graph::reverse_time(back).sketch.frames.size() == 10);
}

TEST_CASE("a reversed motion graph has the reversed events") {
  const auto seed = GENERATE(range(0, 5));
  const graph::MotionGraph motion = random_motion(static_cast<std::uint64_t>(seed));
  const auto there = graph::stroke_events(motion);
  const auto back = graph::reverse_time(graph::stroke_events(graph::reverse_time(motion)), 10);
  CHECK(there.size() > 5);
  REQUIRE(there.size() == back.size());
  for (std::size_t k = 0; k < there.size(); ++k) {
    CHECK(there[k].frame == back[k].frame);
    CHECK(there[k].type == back[k].type);
    CHECK_THAT(graph::distance(there[k].position, back[k].position), WithinAbs(0, 1e-9));
    CHECK(there[k].before.size() == back[k].before.size());
    CHECK(there[k].after.size() == back[k].after.size());
  }
}

TEST_CASE("links reversed join the same patches") {
  // One stroke, one more born in the second frame; a patch of the first frame splits.
  test::Frame first, second;
  first.line(test::segment({10, 10}, {20, 10}, 3));
  second.line(test::segment({10, 40}, {20, 40}, 3));
  second.line(test::segment({11, 10}, {26, 10}, 4));
  const auto motion =
      graph::identify(test::motion({first.graph(), second.graph()}, {{{0, 3}, {1, 4}, {2, 5}, {2, 6}}}));
  const auto back = graph::reverse_time(motion);
  REQUIRE(back.sketch.frames.size() == 2);
  CHECK(back.sketch.frames[0].size() == 7);
  CHECK(back.sketch.frames[0].vertices()[0].id.value == 0);
  CHECK(back.sketch.width == motion.sketch.width);
  CHECK(back.sketch.fps == motion.sketch.fps);
  const std::vector<graph::Link> expected = {{{3}, {7}}, {{4}, {8}}, {{5}, {9}}, {{6}, {9}}};
  CHECK(back.links[0].empty());
  CHECK(back.links[1] == expected);
}

TEST_CASE("events reversed") {
  using graph::EventType;
  const graph::Event birth{3, EventType::birth, {1, 2}, 0.5, {}, {{4}}};
  const graph::Event split{5, EventType::split, {3, 4}, 1, {{1}}, {{2}, {3}}};
  const graph::Event connect{7, EventType::connect, {5, 6}, 1, {{5}, {6}}, {{7}}};
  const auto back = graph::reverse_time({birth, split, connect}, 20);
  REQUIRE(back.size() == 3);
  CHECK(back[0] == graph::Event{13, EventType::disconnect, {5, 6}, 1, {{7}}, {{5}, {6}}});
  CHECK(back[1] == graph::Event{15, EventType::merge, {3, 4}, 1, {{2}, {3}}, {{1}}});
  CHECK(back[2] == graph::Event{17, EventType::death, {1, 2}, 0.5, {{4}}, {}});
  CHECK(graph::reverse_time(back, 20) == std::vector<graph::Event>{birth, split, connect});
}

TEST_CASE("an invalid motion graph is not reversed") {
  test::Frame frame;
  frame.line(test::segment({10, 10}, {20, 10}, 3));
  auto motion = test::motion({frame.graph(), frame.graph()}, {{{0, 0}}});
  motion.links[1].push_back({{0}, {99}});
  CHECK_THROWS_AS(graph::reverse_time(motion), core::InputError);
  CHECK(graph::reverse_time(graph::MotionGraph{}) == graph::MotionGraph{});
}
