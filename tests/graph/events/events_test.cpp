// SPDX-License-Identifier: Apache-2.0
#include "graph/events/events.hpp"

#include <algorithm>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

#include "graph/matching/time_reversal.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::Event;
using graph::EventType;

namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

std::vector<Event> events_of(const test::Frame& before, const test::Frame& after, const Pairs& links) {
  return graph::stroke_events(graph::identify(test::motion({before.graph(), after.graph()}, {links})));
}

void check_one(const std::vector<Event>& events, EventType type, graph::Point place) {
  REQUIRE(events.size() == 1);
  CHECK(events[0].frame == 1);
  CHECK(events[0].type == type);
  CHECK(events[0].probability == 1);
  CHECK_THAT(events[0].position.x, WithinAbs(place.x, 1e-9));
  CHECK_THAT(events[0].position.y, WithinAbs(place.y, 1e-9));
}

Pairs mirrored(Pairs links) {
  for (auto& link : links) std::swap(link.first, link.second);
  return links;
}

/// The change in both senses of time: `there` from a to b, `back` from b to a.
void check_both(const test::Frame& a, const test::Frame& b, const Pairs& links, EventType there,
                EventType back, graph::Point place) {
  check_one(events_of(a, b, links), there, place);
  check_one(events_of(b, a, mirrored(links)), back, place);
}

Pairs straight(std::uint32_t first, std::uint32_t count, std::uint32_t shift = 0) {
  Pairs links;
  for (std::uint32_t k = 0; k < count; ++k) links.emplace_back(first + k, first + k + shift);
  return links;
}

Pairs operator+(Pairs a, const Pairs& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

test::Frame lines(const std::vector<std::vector<graph::Point>>& all) {
  test::Frame frame;
  for (const auto& points : all) frame.line(points);
  return frame;
}

const std::map<EventType, EventType> kOpposite{
    {EventType::birth, EventType::death},        {EventType::death, EventType::birth},
    {EventType::split, EventType::merge},        {EventType::merge, EventType::split},
    {EventType::connect, EventType::disconnect}, {EventType::disconnect, EventType::connect}};

/// Frame, type, place and how many strokes before and after: what does not depend on how strokes are
/// numbered.
using Facts = std::tuple<int, int, double, double, std::size_t, std::size_t>;

std::multiset<Facts> facts(const std::vector<Event>& events) {
  std::multiset<Facts> result;
  for (const Event& e : events) {
    result.emplace(e.frame, static_cast<int>(e.type), e.position.x, e.position.y, e.before.size(),
                   e.after.size());
  }
  return result;
}

std::multiset<Facts> turned(const std::vector<Event>& events, int frames) {
  std::multiset<Facts> result;
  for (const Event& e : events) {
    result.emplace(frames - e.frame, static_cast<int>(kOpposite.at(e.type)), e.position.x, e.position.y,
                   e.after.size(), e.before.size());
  }
  return result;
}

}  // namespace

TEST_CASE("Every event type has a name that leads back to it", "[graph][events]") {
  for (int i = 0; i < 6; ++i) {
    const auto type = static_cast<EventType>(i);
    CHECK(graph::event_type(graph::name(type)) == type);
  }
  CHECK_FALSE(graph::event_type("separate"));
}

TEST_CASE("A stroke is born and dies at its middle", "[graph][events]") {
  const auto stays = test::segment({0, 100}, {40, 100}, 9);
  const test::Frame a = lines({stays});
  // An L of 20 + 10 px: its middle is 15 px from either end.
  const test::Frame b = lines({stays, {{50, 0}, {60, 0}, {70, 0}, {70, 10}}});
  check_both(a, b, straight(0, 9), EventType::birth, EventType::death, {65, 0});
  // A branch does not move it: the longest path counts.
  test::Frame branched = b;
  branched.line({{65, 3}});
  branched.edge(10, 13);
  check_both(a, branched, straight(0, 9), EventType::birth, EventType::death, {65, 0});
  check_both(a, lines({stays, {{7, 8}}}), straight(0, 9), EventType::birth, EventType::death, {7, 8});
}

TEST_CASE("A gap that closes along a line is a merge, at its middle", "[graph][events]") {
  const test::Frame apart = lines({test::segment({0, 0}, {20, 0}, 5), test::segment({40, 0}, {60, 0}, 5)});
  const test::Frame one = lines({test::segment({0, 0}, {60, 0}, 13)});
  check_both(apart, one, straight(0, 5) + straight(5, 5, 3), EventType::merge, EventType::split, {30, 0});
  // With nothing new between them they meet at the middle of the edge.
  test::Frame touching = apart;
  touching.edge(4, 5);
  check_both(apart, touching, straight(0, 10), EventType::merge, EventType::split, {30, 0});
}

TEST_CASE("A union is a merge as long as it turns by less than 30 degrees at both ends", "[graph][events]") {
  for (const double degrees : {0.0, 20.0, 28.0, 32.0, 60.0, 90.0}) {
    const double turn = degrees * std::numbers::pi / 180;
    // Both lines fall away from the gap's line by `turn`.
    const graph::Point down{20 * std::cos(turn), 20 * std::sin(turn)};
    test::Frame apart = lines({test::segment({-10 - down.x, down.y}, {-10, 0}, 5),
                               test::segment({10, 0}, {10 + down.x, down.y}, 5)});
    test::Frame one = apart;
    one.line(test::segment({-5, 0}, {5, 0}, 3));
    one.edge(4, 10);
    one.edge(12, 5);
    const bool straight_on = degrees < 30;
    check_both(apart, one, straight(0, 10), straight_on ? EventType::merge : EventType::connect,
               straight_on ? EventType::split : EventType::disconnect, {0, 0});
    // One end that turns is enough to be no merge.
    test::Frame half =
        lines({test::segment({-30, 0}, {-10, 0}, 5), test::segment({10, 0}, {10 + down.x, down.y}, 5)});
    test::Frame whole = half;
    whole.edge(4, 5);
    check_both(half, whole, straight(0, 10), straight_on ? EventType::merge : EventType::connect,
               straight_on ? EventType::split : EventType::disconnect, {0, 0});
  }
}

TEST_CASE("A bridge between two strokes connects them at its middle and is not born", "[graph][events]") {
  const test::Frame two = lines({test::segment({0, 0}, {40, 0}, 9), test::segment({0, 30}, {40, 30}, 9)});
  test::Frame bridged = two;
  const auto bridge = bridged.line(test::segment({20, 5}, {20, 20}, 4));
  bridged.edge(4, bridge);
  bridged.edge(bridge + 3, 13);
  check_both(two, bridged, straight(0, 18), EventType::connect, EventType::disconnect, {20, 15});
  // A T without anything between, from the end of one line to the side of the other.
  const test::Frame tee = lines({test::segment({0, 0}, {40, 0}, 9), test::segment({20, 6}, {20, 26}, 5)});
  test::Frame joined = tee;
  joined.edge(4, 9);
  check_both(tee, joined, straight(0, 14), EventType::connect, EventType::disconnect, {20, 3});
  // In line with one of them, but in the middle of the other.
  test::Frame side = lines({test::segment({0, 0}, {0, 40}, 9), test::segment({10, 20}, {30, 20}, 5)});
  test::Frame sided = side;
  sided.edge(4, 9);
  check_both(side, sided, straight(0, 14), EventType::connect, EventType::disconnect, {5, 20});
}

TEST_CASE("A bridge that leaves a stub at its foot is a bridge all the same", "[graph][events]") {
  // The stub looks like an end that the other stroke continues, but the stroke it stands on goes on to both
  // sides.
  test::Frame apart = lines({test::segment({0, 0}, {0, 60}, 13), test::segment({35, 30}, {75, 30}, 9)});
  const auto stub = apart.line({{5, 30}});
  apart.edge(6, stub);
  test::Frame joined = apart;
  const auto bridge = joined.line(test::segment({10, 30}, {30, 30}, 5));
  joined.edge(stub, bridge);
  joined.edge(bridge + 4, 13);
  test::Frame bare = lines({test::segment({0, 0}, {0, 60}, 13), test::segment({35, 30}, {75, 30}, 9)});
  check_both(bare, joined, straight(0, 6) + straight(7, 15) + Pairs{{6, stub}}, EventType::connect,
             EventType::disconnect, {20, 30});
}

TEST_CASE("What fades between two strokes in one more frame belongs to neither", "[graph][events]") {
  // A line of 25 patches; its patches 9 to 15 still hang on the right part in the frame of the separation,
  // and are gone in the next.
  const test::Frame whole = lines({test::segment({0, 0}, {120, 0}, 25)});
  const test::Frame hanging =
      lines({test::segment({0, 0}, {40, 0}, 9), test::segment({45, 0}, {120, 0}, 16)});
  const test::Frame gone = lines({test::segment({0, 0}, {40, 0}, 9), test::segment({80, 0}, {120, 0}, 9)});
  const Pairs on = straight(0, 25), off = straight(0, 9) + straight(16, 9, -7U);
  const auto place_of = [](const std::vector<graph::AttributeGraph>& frames,
                           const std::vector<Pairs>& links) {
    const auto events = graph::stroke_events(graph::identify(test::motion(frames, links)));
    REQUIRE(events.size() == 1);
    CHECK(events[0].type != EventType::birth);
    CHECK(events[0].type != EventType::death);
    return events[0].position.x;
  };
  CHECK_THAT(place_of({whole.graph(), hanging.graph(), gone.graph()}, {on, off}), WithinAbs(60, 1e-9));
  CHECK_THAT(place_of({gone.graph(), hanging.graph(), whole.graph()}, {mirrored(off), mirrored(on)}),
             WithinAbs(60, 1e-9));
  // One patch alone does not fade: the curve was cut anew.
  const test::Frame recut = lines({test::segment({0, 0}, {40, 0}, 9), test::segment({50, 0}, {120, 0}, 15)});
  const Pairs without_one = straight(0, 9) + straight(10, 15, -1U);
  CHECK_THAT(place_of({whole.graph(), hanging.graph(), recut.graph()}, {on, without_one}),
             WithinAbs(42.5, 1e-9));
  // Of what stays, and where the clip ends there, nothing is known to fade.
  CHECK_THAT(place_of({whole.graph(), hanging.graph(), hanging.graph()}, {on, on}), WithinAbs(42.5, 1e-9));
  CHECK_THAT(place_of({whole.graph(), hanging.graph()}, {on}), WithinAbs(42.5, 1e-9));
}

TEST_CASE("Growing, branching, and closing a loop are no events", "[graph][events]") {
  const test::Frame line = lines({test::segment({0, 0}, {40, 0}, 9)});
  const test::Frame longer = lines({test::segment({0, 0}, {60, 0}, 13)});
  CHECK(events_of(line, longer, straight(0, 9)).empty());
  CHECK(events_of(longer, line, straight(0, 9)).empty());
  test::Frame branched = line;
  const auto branch = branched.line(test::segment({20, 5}, {20, 20}, 4));
  branched.edge(4, branch);
  CHECK(events_of(line, branched, straight(0, 9)).empty());
  test::Frame loop = branched;
  loop.edge(branch + 3, 8);
  CHECK(events_of(branched, loop, straight(0, 13)).empty());
  CHECK(events_of(loop, branched, straight(0, 13)).empty());
  CHECK(events_of(line, loop, straight(0, 9)).empty());
}

TEST_CASE("Three strokes that become one are two unions, each in its place", "[graph][events]") {
  const auto a = test::segment({0, 0}, {20, 0}, 5), b = test::segment({40, 0}, {60, 0}, 5),
             c = test::segment({50, 30}, {50, 50}, 5);
  const test::Frame apart = lines({a, b, c});
  test::Frame one = apart;
  const auto gap = one.line({{30, 0}});
  one.edge(4, gap);
  one.edge(gap, 5);
  const auto bridge = one.line({{50, 10}, {50, 20}});
  one.edge(7, bridge);
  one.edge(bridge + 1, 10);
  const auto events = events_of(apart, one, straight(0, 15));
  REQUIRE(events.size() == 2);
  CHECK(events[0].type == EventType::merge);
  CHECK(events[0].position == graph::Point{30, 0});
  CHECK(events[0].before == std::vector<graph::SubgraphId>{{1}, {2}});
  CHECK(events[0].after == std::vector<graph::SubgraphId>{{4}});
  CHECK(events[1].type == EventType::connect);
  CHECK(events[1].position == graph::Point{50, 15});
  CHECK(events[1].before == std::vector<graph::SubgraphId>{{2}, {3}});
}

TEST_CASE("A piece that goes over from one stroke to another is a separation and a union",
          "[graph][events]") {
  // Three pieces in a row: first the left two are one stroke, then the right two.
  const auto a = test::segment({0, 0}, {40, 0}, 9), b = test::segment({50, 0}, {65, 0}, 4),
             c = test::segment({80, 0}, {120, 0}, 9);
  test::Frame left = lines({a, b, c}), right = left;
  left.edge(8, 9);
  right.edge(12, 13);
  const auto events = events_of(left, right, straight(0, 22));
  REQUIRE(events.size() == 2);
  CHECK(events[0].type == EventType::split);
  CHECK(events[0].position == graph::Point{45, 0});
  CHECK(events[1].type == EventType::merge);
  CHECK(events[1].position == graph::Point{72.5, 0});
}

TEST_CASE("Two patches that become one join their strokes there", "[graph][events]") {
  const test::Frame apart = lines({test::segment({0, 0}, {20, 0}, 5), test::segment({22, 0}, {42, 0}, 5)});
  const test::Frame one = lines({test::segment({1, 0}, {41, 0}, 9)});
  const Pairs links = straight(0, 4) + Pairs{{4, 4}, {5, 4}} + straight(6, 4, ~0U);
  check_both(apart, one, links, EventType::merge, EventType::split, {21, 0});
}

TEST_CASE("The frame of an event is the first one that shows it", "[graph][events]") {
  const test::Frame one = lines({test::segment({0, 0}, {20, 0}, 5)});
  const test::Frame two = lines({test::segment({0, 0}, {20, 0}, 5), test::segment({0, 50}, {20, 50}, 5)});
  const auto g = one.graph(), h = two.graph();
  const auto events = graph::stroke_events(graph::identify(
      test::motion({g, g, h, h, g}, {straight(0, 5), straight(0, 5), straight(0, 10), straight(0, 5)})));
  REQUIRE(events.size() == 2);
  CHECK(events[0] == Event{2, EventType::birth, {10, 50}, 1, {}, {{2}}});
  CHECK(events[1] == Event{4, EventType::death, {10, 50}, 1, {{2}}, {}});
  CHECK(graph::stroke_events({}).empty());
}

TEST_CASE("A clip played backwards has the opposite events at the same places", "[graph][events]") {
  std::map<EventType, int> seen;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const auto motion = graph::identify(test::random_motion(seed, 4, static_cast<int>(seed % 17)));
    const auto mirror = graph::reverse_time(motion);
    const auto there = graph::stroke_events(motion);
    CHECK(turned(there, 4) == facts(graph::stroke_events(mirror)));
    for (const Event& event : there) ++seen[event.type];
  }
  CHECK(seen.size() == 6);
}

TEST_CASE("A cluster of p strokes before and q after has p - 1 unions and q - 1 separations",
          "[graph][events]") {
  for (std::uint64_t seed = 1000; seed < 1200; ++seed) {
    const auto motion = graph::identify(test::random_motion(seed, 2, static_cast<int>(seed % 23)));
    const auto &before = motion.sketch.frames[0], &after = motion.sketch.frames[1];
    const auto p = graph::components(before), q = graph::components(after);
    // Clusters by spreading the lowest label until nothing changes.
    std::vector<std::size_t> cluster(p.count + q.count);
    for (std::size_t k = 0; k < cluster.size(); ++k) cluster[k] = k;
    for (std::size_t round = 0; round < cluster.size(); ++round) {
      for (const auto& link : motion.links[1]) {
        auto& a = cluster[p.of_vertex[before.index_of(link.before)]];
        auto& b = cluster[p.count + q.of_vertex[after.index_of(link.after)]];
        a = b = std::min(a, b);
      }
    }
    int births = 0, deaths = 0, unions = 0, separations = 0;
    for (const std::size_t name : std::set<std::size_t>(cluster.begin(), cluster.end())) {
      const auto pieces_before =
          std::count(cluster.begin(), cluster.begin() + static_cast<std::ptrdiff_t>(p.count), name);
      const auto pieces_after =
          std::count(cluster.begin() + static_cast<std::ptrdiff_t>(p.count), cluster.end(), name);
      births += pieces_before == 0;
      deaths += pieces_after == 0;
      if (pieces_before > 0 && pieces_after > 0) {
        unions += static_cast<int>(pieces_before) - 1;
        separations += static_cast<int>(pieces_after) - 1;
      }
    }
    for (const Event& event : graph::stroke_events(motion)) {
      switch (event.type) {
        case EventType::birth:
          --births;
          break;
        case EventType::death:
          --deaths;
          break;
        case EventType::merge:
        case EventType::connect:
          --unions;
          break;
        default:
          --separations;
      }
    }
    CHECK(std::tuple(births, deaths, unions, separations) == std::tuple(0, 0, 0, 0));
  }
}

TEST_CASE("A traced event has the patches that appeared or vanished") {
  const std::vector<graph::Point> whole{{10, 50}, {15, 50}, {20, 50}, {25, 50}, {30, 50}, {35, 50}, {40, 50}};
  const test::Frame joined = lines({whole});
  const test::Frame apart = lines({{whole[0], whole[1], whole[2]}, {whole[4], whole[5], whole[6]}});
  const Pairs links = straight(0, 3) + Pairs{{4, 3}, {5, 4}, {6, 5}};
  const auto check = [](const test::Frame& before, const test::Frame& after, const Pairs& l, EventType type,
                        int frame) {
    const auto motion = graph::identify(test::motion({before.graph(), after.graph()}, {l}));
    const auto traced = graph::trace_stroke_events(motion);
    REQUIRE(traced.size() == 1);
    CHECK(traced[0].event == graph::stroke_events(motion)[0]);
    CHECK(traced[0].event.type == type);
    CHECK(traced[0].path_frame == frame);
    const graph::AttributeGraph& g = motion.sketch.frames[static_cast<std::size_t>(frame)];
    std::vector<double> x;
    for (const graph::VertexId id : traced[0].path) x.push_back(g.patch(g.index_of(id)).position.x);
    std::ranges::sort(x);
    return x;
  };
  CHECK(check(joined, apart, links, EventType::split, 0) == std::vector<double>{20, 25, 30});
  CHECK(check(apart, joined, mirrored(links), EventType::merge, 1) == std::vector<double>{20, 25, 30});
  const test::Frame one = lines({{{10, 50}, {15, 50}, {20, 50}}});
  const test::Frame two = lines({{{10, 50}, {15, 50}, {20, 50}}, {{60, 50}, {65, 50}, {70, 50}}});
  CHECK(check(one, two, straight(0, 3), EventType::birth, 1) == std::vector<double>{60, 65, 70});
  CHECK(check(two, one, straight(0, 3), EventType::death, 0) == std::vector<double>{60, 65, 70});
}
