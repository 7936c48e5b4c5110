// SPDX-License-Identifier: Apache-2.0
#include "graph/events/topology_changes.hpp"

#include <algorithm>
#include <numbers>
#include <sstream>

#include "core/error.hpp"
#include "graph/io/contact_tables.hpp"
#include "graph/network/network_figures.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;
using graph::Change;
using graph::Contact;
using graph::Point;
using graph::TopologyChange;

namespace {

struct Sums {
  int tips = 0, branches = 0, components = 0, loops = 0;
  bool operator==(const Sums&) const = default;
};
Sums figures_of(const graph::AttributeGraph& graph) {
  const auto f = graph::network_figures(graph);
  return {static_cast<int>(f.tips + 2 * f.points), static_cast<int>(f.branches),
          static_cast<int>(f.components), static_cast<int>(f.loops)};
}

/// Whether in every frame the figures change by the sums over the changes.
bool is_balanced(const graph::MotionGraph& motion, const std::vector<TopologyChange>& changes) {
  for (std::size_t t = 1; t < motion.sketch.frames.size(); ++t) {
    Sums said = figures_of(motion.sketch.frames[t - 1]);
    for (const TopologyChange& c : changes) {
      if (c.frame != static_cast<int>(t)) continue;
      said.tips += c.tips, said.branches += c.branches, said.components += c.components,
          said.loops += c.loops;
    }
    if (said != figures_of(motion.sketch.frames[t])) return false;
  }
  return true;
}

/// Two frames whose vertices have the same numbers, the second with more of them.
std::vector<TopologyChange> changes_to(const test::Frame& a, const test::Frame& b) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
  for (std::uint32_t v = 0; v < std::min(a.vertices.size(), b.vertices.size()); ++v) links.emplace_back(v, v);
  const auto motion = graph::identify(test::motion({a.graph(), b.graph()}, {links}));
  auto changes = graph::topology_changes(motion);
  CHECK(is_balanced(motion, changes));
  return changes;
}

/// Two forks d px apart: one beside the other or, `turned`, one above the other, with four arms to the
/// corners.
graph::AttributeGraph two_forks(double d, bool turned, double sway) {
  test::Frame frame;
  const graph::Point middle{100 + sway, 100}, half = turned ? graph::Point{0, d / 2} : graph::Point{d / 2, 0};
  const auto edge = frame.line({middle - half, middle, middle + half});
  for (int k = 0; k < 4; ++k) {
    const graph::Point out{k % 2 == 0 ? -1.0 : 1.0, k < 2 ? -1.0 : 1.0};
    const auto arm = frame.line(test::segment(middle + out * 12, middle + out * 40, 5));
    const bool first = (turned ? out.y : out.x) < 0;
    frame.edge(first ? edge : edge + 2, arm);
  }
  return frame.graph();
}

/// Frames of forks that come together and part, the other way where `turns`; all patches are linked.
graph::MotionGraph closing_forks(bool turns, int flips) {
  std::vector<graph::AttributeGraph> frames;
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> links;
  for (int t = 0; t < 20; ++t) {
    const double d = flips > 0 ? 4 : std::abs(t - 9.5) * 2;
    const bool turned = flips > 0 ? t / flips % 2 == 1 : turns && t >= 10;
    frames.push_back(two_forks(d, turned, 0.4 * t));
    if (t == 0) continue;
    links.emplace_back();
    for (std::uint32_t v = 0; v < 23; ++v) links.back().emplace_back(v, v);
  }
  return graph::identify(test::motion(frames, links));
}

}  // namespace

TEST_CASE("In every frame of any motion graph the figures change as the events say", "[graph][events]") {
  int rings = 0, branches = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const auto motion = graph::identify(test::random_motion(seed, 6, 8));
    const auto changes = graph::topology_changes(motion);
    REQUIRE(is_balanced(motion, changes));
    // the six classes are the events, but for what passes the border
    const auto events = graph::stroke_events(motion);
    CHECK(std::ranges::count_if(changes, [](const TopologyChange& c) {
            return c.change <= Change::disconnect || c.change == Change::enters || c.change == Change::leaves;
          }) == static_cast<std::ptrdiff_t>(events.size()));
    for (const TopologyChange& c : changes) {
      CHECK(c.tips - c.branches == 2 * (c.components - c.loops));
      rings += c.change == Change::ring_closed || c.change == Change::ring_opened ? 1 : 0;
      branches += c.change == Change::branch_extruded || c.change == Change::branch_retracted ? 1 : 0;
    }
  }
  CHECK((rings > 50 && branches > 50));
}

TEST_CASE("A stroke that moves through the border enters or leaves; one that ends next to it dies",
          "[graph][events]") {
  // a line parallel to the left border, which it moves towards by `step` px a frame, away from it backwards
  const auto changes_of = [](double step, bool backwards) {
    std::vector<graph::AttributeGraph> frames;
    std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> links(5);
    for (int t = 0; t < 5; ++t) {
      test::Frame frame;
      const double x = 3 + step * (4 - t);
      frame.line(test::segment({x, 100}, {x, 140}, 9));
      frames.push_back(frame.graph());
      for (std::uint32_t v = 0; t > 0 && v < 9; ++v)
        links[static_cast<std::size_t>(t - 1)].emplace_back(v, v);
    }
    frames.emplace_back();
    if (backwards) std::ranges::reverse(frames), std::ranges::reverse(links);
    const auto motion = graph::identify(test::motion(frames, links));
    const auto changes = graph::topology_changes(motion);
    CHECK(is_balanced(motion, changes));
    REQUIRE(changes.size() == 1);
    return changes.front().change;
  };
  CHECK(changes_of(4, false) == Change::leaves);
  CHECK(changes_of(4, true) == Change::enters);
  CHECK(changes_of(0, false) == Change::death);
  CHECK(changes_of(0, true) == Change::birth);
}

TEST_CASE("A short line that the border cuts off leaves; a small ring that shrinks near it dies",
          "[graph][events]") {
  // what vanishes after frame 1: its far end is nearer to the left border by `by` px than in frame 0
  const auto leaves = [](const std::vector<Point>& last, double by, bool is_ring) {
    std::vector<graph::AttributeGraph> frames;
    for (const double x : {by, 0.0}) {
      std::vector<Point> line = last;
      for (std::size_t v = is_ring ? 2 : 0; v < line.size(); ++v) line[v].x += x;
      test::Frame frame;
      frame.line(line);
      if (is_ring) frame.edge(0, 3);
      frames.push_back(frame.graph());
    }
    frames.emplace_back();
    std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
    for (std::uint32_t v = 0; v < last.size(); ++v) links.emplace_back(v, v);
    const auto changes = graph::topology_changes(graph::identify(test::motion(frames, {links, {}})));
    return std::ranges::count(changes, Change::leaves, &TopologyChange::change) == 1;
  };
  const std::vector<Point> line{{1, 100}, {6, 100}, {11, 100}},
      ring{{4, 100}, {4, 107}, {11, 107}, {11, 100}};
  CHECK(leaves(line, 2, false));
  CHECK_FALSE(leaves(line, 0, false));
  CHECK_FALSE(leaves(ring, 2, true));
  CHECK_FALSE(leaves({{1, 100}, {6, 100}, {11, 100}, {16, 100}}, 2, false));
}

TEST_CASE("A ring that the border cuts off enters; one away from it is born", "[graph][events]") {
  const auto change_of = [](double x) {
    test::Frame frame;
    frame.line({{x, 100}, {x, 120}, {x, 140}, {x + 20, 140}, {x + 20, 120}, {x + 20, 100}});
    frame.edge(0, 5);
    const auto changes = graph::topology_changes(
        graph::identify(test::motion({graph::AttributeGraph(), frame.graph()}, {{}})));
    REQUIRE(changes.size() == 2);
    CHECK(std::ranges::count(changes, Change::ring_closed, &TopologyChange::change) == 1);
    return changes[changes[0].change == Change::ring_closed ? 1 : 0].change;
  };
  CHECK(change_of(1) == Change::enters);
  CHECK(change_of(8) == Change::birth);
}

TEST_CASE("A branch that grows out of a line, and goes, is one change with a length", "[graph][events]") {
  test::Frame line;
  line.line(test::segment({20, 100}, {120, 100}, 11));
  test::Frame fork = line;
  fork.edge(5, fork.line(test::segment({70, 108}, {70, 124}, 3)));
  for (const bool grows : {true, false}) {
    const auto changes = grows ? changes_to(line, fork) : changes_to(fork, line);
    REQUIRE(changes.size() == 1);
    CHECK(changes[0].change == (grows ? Change::branch_extruded : Change::branch_retracted));
    CHECK(changes[0].position == graph::Point{70, 124});
    CHECK(changes[0].length == 24);
    CHECK((changes[0].tips == (grows ? 1 : -1) && changes[0].branches == changes[0].tips));
  }
}

TEST_CASE("A ring closes tip to tip, tip to side and by a bridge", "[graph][events]") {
  test::Frame open;
  std::vector<graph::Point> arc;
  for (int k = 0; k < 20; ++k) {
    const double angle = 2 * std::numbers::pi * k / 21;
    arc.push_back({100 + 40 * std::cos(angle), 100 + 40 * std::sin(angle)});
  }
  open.line(arc);
  const auto closes = [&](std::uint32_t a, std::uint32_t b, Contact contact) {
    test::Frame closed = open;
    closed.edge(a, b);
    for (const bool closing : {true, false}) {
      const auto changes = closing ? changes_to(open, closed) : changes_to(closed, open);
      REQUIRE(changes.size() == 1);
      CHECK(changes[0].change == (closing ? Change::ring_closed : Change::ring_opened));
      CHECK(changes[0].contact == contact);
      CHECK(changes[0].loops == (closing ? 1 : -1));
      CHECK(graph::distance(changes[0].position, {100, 100}) < 45);
    }
  };
  closes(0, 19, Contact::tip_tip);
  closes(0, 10, Contact::tip_side);
  closes(4, 15, Contact::side_side);
}

TEST_CASE("A swap of neighbours is one change that adds nothing", "[graph][events]") {
  const auto motion = closing_forks(true, 0);
  const auto changes = graph::topology_changes(motion);
  CHECK(is_balanced(motion, changes));
  REQUIRE(changes.size() == 1);
  CHECK(changes[0].change == Change::t1);
  CHECK((changes[0].frame >= 9 && changes[0].frame <= 12));
  CHECK(graph::distance(changes[0].position, {104, 100}) < 3);
  // forks that part as they met, and those of a crossing that take turns, swap nothing
  CHECK(graph::find_neighbour_swaps(closing_forks(false, 0)).empty());
  for (const int flips : {1, 2, 3}) CHECK(graph::find_neighbour_swaps(closing_forks(false, flips)).empty());
}

TEST_CASE("Neighbours swap only where the arms stay in their places", "[graph][events]") {
  // Two forks 16 px apart with two arms each, beside each other and then above each other.
  const auto forks = [](double slope, bool above) {
    const auto at = [&](double x, double y) {
      return above ? graph::Point{100 + y, 100 + x} : graph::Point{100 + x, 100 + y};
    };
    test::Frame frame;
    frame.line({at(-8, 0), at(8, 0)});
    for (const double side : {-1.0, 1.0})
      for (const double rise : {-slope, slope})
        frame.edge(side < 0 ? 0 : 1, frame.line({at(28 * side, 28 * rise)}));
    return frame.graph();
  };
  const auto swaps = [&](double slope) {
    graph::MotionGraph motion;
    for (int t = 0; t < 20; ++t) motion.sketch.append(forks(slope, t >= 10));
    motion.links.resize(20);
    return graph::find_neighbour_swaps(motion).size();
  };
  CHECK(swaps(0.75) == 1);  // arms turn by 16°
  CHECK(swaps(0.2) == 0);   // by 67°: other arms
}

TEST_CASE("The table of changes, in px and in units", "[graph][io]") {
  std::ostringstream plain, with, broken;
  TopologyChange change{4, Change::branch_retracted, {1, 2}, Contact::none, -1, -1, 0, 0, 8};
  graph::write_topology(plain, std::vector{change}, {});
  CHECK(plain.str() ==
        "frame,change,contact,x,y,tips,branches,components,loops,length\n"
        "4,branch_retracted,,1,2,-1,-1,0,0,8\n");
  graph::write_topology(with, std::vector{change}, {0.5, 0.5});
  CHECK(test::Contains(",length,time_s,x_um,y_um,length_um\n4,branch_retracted,,1,2,-1,-1,0,0,8,2,0.5,1,4\n")
            .match(with.str()));
  broken.setstate(std::ios::failbit);
  CHECK_THROWS_AS(graph::write_topology(broken, std::vector{change}, {}), core::IoError);
}
