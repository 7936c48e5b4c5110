// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/flicker_removal.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "graph/events/events.hpp"
#include "graph/matching/match.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using graph::AttributeGraph;
using graph::Edge;
using graph::EventType;
using graph::Patch;
using graph::Point;
using graph::Vertex;
using graph::VertexId;

namespace {

struct Line {
  Point from, to;
};

// Straight strokes of patches 5 px apart; strokes that share an end share its patch.
AttributeGraph draw(const std::vector<Line>& lines) {
  std::vector<Vertex> vertices;
  std::set<Edge> edges;
  const auto vertex_at = [&](Point p, double theta) {
    for (const Vertex& v : vertices)
      if (graph::distance(v.patch.position, p) < 0.5) return v.id;
    Patch patch;
    patch.position = p;
    patch.theta = theta;
    patch.width = 3;
    patch.contrast = 50;
    const VertexId id{static_cast<std::uint32_t>(vertices.size())};
    vertices.push_back({id, {}, patch});
    return id;
  };
  for (const Line& line : lines) {
    const Point way = line.to - line.from;
    const int pieces = static_cast<int>(std::lround(graph::norm(way) / 5));
    VertexId previous = vertex_at(line.from, std::atan2(way.y, way.x));
    for (int i = 1; i <= pieces; ++i) {
      const VertexId next = vertex_at(line.from + way * (1.0 * i / pieces), std::atan2(way.y, way.x));
      edges.insert({std::min(previous, next), std::max(previous, next)});
      previous = next;
    }
  }
  return {vertices, {edges.begin(), edges.end()}};
}

const std::vector<Line> kStroke = {{{40, 20}, {40, 80}}};
const std::vector<Line> kTorn = {{{40, 20}, {40, 45}}, {{40, 55}, {40, 80}}};
const std::vector<Line> kPair = {{{40, 20}, {40, 80}}, {{60, 20}, {60, 80}}};
const std::vector<Line> kBridged = {{{40, 20}, {40, 80}}, {{60, 20}, {60, 80}}, {{40, 50}, {60, 50}}};
const std::vector<Line> kCompany = {{{40, 20}, {40, 80}}, {{100, 20}, {100, 60}}};

// Twelve frames that show `usual`, but `other` in [first, last).
std::vector<graph::Event> events_with(const std::vector<Line>& usual, const std::vector<Line>& other,
                                      int first, int last, int flicker) {
  graph::SketchSequence sketch{160, 120, 25, {}};
  for (int t = 0; t < 12; ++t) sketch.append(draw(t >= first && t < last ? other : usual));
  graph::MatchOptions options;
  options.flicker = flicker;
  return graph::stroke_events(graph::match(sketch, options));
}

}  // namespace

TEST_CASE("What flickers for up to three frames makes no events, what lasts longer does", "[graph][steady]") {
  struct Case {
    const char* name;
    std::vector<Line> usual, other;
    EventType first, second;
  };
  const std::vector<Case> cases = {
      {"a stroke that tears", kStroke, kTorn, EventType::split, EventType::merge},
      {"pieces that touch", kTorn, kStroke, EventType::merge, EventType::split},
      {"strokes that are bridged", kPair, kBridged, EventType::connect, EventType::disconnect},
      {"a bridge that is lost", kBridged, kPair, EventType::disconnect, EventType::connect},
      {"a stroke that is missing", kCompany, kStroke, EventType::death, EventType::birth}};
  for (const Case& c : cases) {
    INFO(c.name);
    for (const int length : {1, 2, 3}) {
      INFO(length << " frames");
      CHECK(events_with(c.usual, c.other, 5, 5 + length, 0).size() == 2);
      CHECK(events_with(c.usual, c.other, 5, 5 + length, 3).empty());
    }
    const auto lasting = events_with(c.usual, c.other, 4, 9, 3);
    REQUIRE(lasting.size() == 2);
    CHECK(lasting[0].frame == 4);
    CHECK(lasting[0].type == c.first);
    CHECK(lasting[1].frame == 9);
    CHECK(lasting[1].type == c.second);
  }
}

TEST_CASE("A wide stretch that is missed for a moment is mended, one that is missed for longer is not",
          "[graph][steady]") {
  const std::vector<Line> whole = {{{40, 10}, {40, 110}}},
                          torn = {{{40, 10}, {40, 35}}, {{40, 80}, {40, 110}}};
  CHECK(events_with(whole, torn, 5, 7, 3).empty());
  const auto events = events_with(whole, torn, 4, 9, 3);
  REQUIRE(events.size() == 2);
  CHECK((events[0].type == EventType::disconnect || events[0].type == EventType::split));
  // Two strokes that part here and unite far away are two strokes in between.
  const std::vector<Line> other = {{{40, 10}, {40, 35}},
                                   {
                                       {40, 80},
                                       {40, 110},
                                   },
                                   {{40, 35}, {20, 35}}};
  CHECK_FALSE(events_with(whole, other, 5, 9, 3).empty());
}

TEST_CASE("A stroke at the clip's first or last frames is left out only if it is there for one frame",
          "[graph][steady]") {
  CHECK(events_with(kStroke, kCompany, 0, 1, 3).empty());
  CHECK(events_with(kStroke, kCompany, 11, 12, 3).empty());
  const auto begins = events_with(kStroke, kCompany, 0, 2, 3),
             ends = events_with(kStroke, kCompany, 10, 12, 3);
  REQUIRE(begins.size() == 1);
  CHECK((begins[0].type == EventType::death && begins[0].frame == 2));
  REQUIRE(ends.size() == 1);
  CHECK((ends[0].type == EventType::birth && ends[0].frame == 10));
}

TEST_CASE("Steadying a steady sequence changes nothing", "[graph][steady]") {
  graph::SketchSequence sketch{160, 120, 25, {}};
  for (int t = 0; t < 10; ++t) sketch.append(draw(t < 5 ? kPair : kBridged));
  graph::MatchOptions options;
  options.flicker = 0;
  const graph::MotionGraph motion = graph::match(sketch, options);
  CHECK(graph::remove_flicker(motion, 3) == motion.sketch);
  CHECK(graph::remove_flicker(motion, 0) == motion.sketch);
}

namespace {

std::vector<graph::Event> events_of(const std::vector<AttributeGraph>& frames) {
  graph::SketchSequence sketch{160, 120, 25, {}};
  for (const AttributeGraph& frame : frames) sketch.append(frame);
  return graph::stroke_events(graph::match(sketch, {}));
}

}  // namespace

TEST_CASE("A stroke that falls into pieces as it fades dies once and one that appears in pieces is born once",
          "[graph][steady]") {
  const Line other{{100, 20}, {100, 60}};
  const AttributeGraph gone = draw({other}), whole = draw({other, kStroke[0]}),
                       torn = draw({other, kTorn[0], kTorn[1]}), rest = draw({other, kTorn[0]});
  std::vector<AttributeGraph> fading(6, whole);
  fading.insert(fading.end(), {torn, torn, rest, gone, gone, gone, gone, gone});
  const auto dies = events_of(fading);
  REQUIRE(dies.size() == 1);
  CHECK(dies[0].type == EventType::death);
  CHECK(dies[0].frame == 9);
  std::reverse(fading.begin(), fading.end());
  const auto born = events_of(fading);
  REQUIRE(born.size() == 1);
  CHECK(born[0].type == EventType::birth);
  CHECK(born[0].frame == 5);
  CHECK(graph::distance(born[0].position, dies[0].position) < 1);
}

TEST_CASE("A stroke of which only pieces far apart show for a frame is born and dies once",
          "[graph][steady]") {
  const Line other{{100, 20}, {100, 60}};
  const AttributeGraph gone = draw({other}), whole = draw({other, kStroke[0]}),
                       torn = draw({other, {{40, 20}, {40, 30}}, {{40, 60}, {40, 80}}});
  std::vector<AttributeGraph> frames(4, gone);
  frames.push_back(torn);
  frames.insert(frames.end(), 6, whole);
  frames.push_back(torn);
  frames.insert(frames.end(), 4, gone);
  const auto events = events_of(frames);
  REQUIRE(events.size() == 2);
  CHECK(events[0].type == EventType::birth);
  CHECK(events[0].frame == 4);
  CHECK(events[1].type == EventType::death);
  CHECK(events[1].frame == 12);
  for (const graph::Event& event : events) CHECK(graph::distance(event.position, {40, 50}) < 8);
}

TEST_CASE("A stroke that is there for one frame is left out, one that is there for two stays",
          "[graph][steady]") {
  CHECK(events_with(kStroke, kCompany, 5, 6, 3).empty());
  const auto events = events_with(kStroke, kCompany, 5, 7, 3);
  REQUIRE(events.size() == 2);
  CHECK(events[0].type == EventType::birth);
  CHECK(events[0].frame == 5);
  CHECK(events[1].type == EventType::death);
  CHECK(events[1].frame == 7);
}

TEST_CASE("Of states to and fro the shortest is undone", "[graph][steady]") {
  // Torn from frame 5 on, but for one frame.
  std::vector<AttributeGraph> frames;
  for (int t = 0; t < 14; ++t) frames.push_back(draw(t < 5 || t == 7 ? kStroke : kTorn));
  const auto events = events_of(frames);
  REQUIRE(events.size() == 1);
  CHECK(events[0].type == EventType::split);
  CHECK(events[0].frame == 5);
}

TEST_CASE("A stroke of which a part is seen first is born at its middle", "[graph][steady]") {
  const Line other{{100, 20}, {100, 60}};
  std::vector<AttributeGraph> frames(4, draw({other}));
  frames.push_back(draw({other, {{40, 60}, {40, 80}}}));
  frames.insert(frames.end(), 5, draw({other, kStroke[0]}));
  const auto born = events_of(frames);
  REQUIRE(born.size() == 1);
  CHECK(born[0].frame == 4);
  CHECK(graph::distance(born[0].position, {40, 50}) < 8);
  std::reverse(frames.begin(), frames.end());
  const auto dies = events_of(frames);
  REQUIRE(dies.size() == 1);
  CHECK(graph::distance(dies[0].position, born[0].position) < 1e-9);
}
