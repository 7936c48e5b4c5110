// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/skipped_patches.hpp"

#include <algorithm>
#include <sstream>

#include "graph/io/motion_io.hpp"
#include "graph/matching/time_reversal.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;

namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

// The links into frame 1, by vertex index.
Pairs pairs(const graph::MotionGraph& motion) {
  const auto& frames = motion.sketch.frames;
  Pairs result;
  for (const auto& link : graph::all_links(motion, 1))
    result.emplace_back(frames[0].index_of(link.before), frames[1].index_of(link.after));
  return result;
}

// A curve of five patches; the same curve, 3 px lower, drawn with four. The middle one was left without a
// link.
graph::MotionGraph resampled() {
  test::Frame five, four;
  five.line({{10, 50}, {15, 50}, {20, 50}, {25, 50}, {30, 50}});
  four.line({{10, 53}, {16, 53}, {24, 53}, {30, 53}});
  return test::motion({five.graph(), four.graph()}, {{{0, 0}, {1, 1}, {3, 2}, {4, 3}}});
}

}  // namespace

TEST_CASE("A patch that a curve has no more goes on in its neighbour's partner", "[graph][skipped_patches]") {
  auto motion = resampled();
  graph::link_skipped_patches(motion);
  // The middle of five lies 4 px from both; the tie goes to the lower x.
  CHECK(pairs(motion) == Pairs{{0, 0}, {1, 1}, {2, 1}, {3, 2}, {4, 3}});
  CHECK_NOTHROW(graph::validate(motion));
  // One of the two goes on, the other's course ends.
  std::vector<std::size_t> lengths;
  for (const auto& course : graph::trajectories(motion)) lengths.push_back(course.vertices.size());
  CHECK(lengths == std::vector<std::size_t>{2, 2, 1, 2, 2});
}

TEST_CASE("A patch that a curve did not have before comes of its neighbour's partner",
          "[graph][skipped_patches]") {
  auto motion = graph::reverse_time(resampled());
  graph::link_skipped_patches(motion);
  CHECK(motion.skipped[1].size() == 1);
  // Reversing time gives the same links.
  auto forwards = resampled();
  graph::link_skipped_patches(forwards);
  CHECK(graph::reverse_time(graph::identify(forwards)) == graph::identify(motion));
}

TEST_CASE("Runs of skipped patches follow each other", "[graph][skipped_patches]") {
  test::Frame one;
  one.line({{10, 50}, {15, 50}, {20, 50}, {25, 50}, {30, 50}});
  auto motion = test::motion({one.graph(), one.graph()}, {{{0, 0}}});
  graph::link_skipped_patches(motion);
  CHECK(pairs(motion) == Pairs{{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}});
}

TEST_CASE("A skipped patch goes on at most 7.5 px along it and 3 px across", "[graph][skipped_patches]") {
  const auto linked = [](graph::Point last) {
    test::Frame one, other;
    one.line({{10, 50}, {15, 50}, last});
    one.vertices[2].patch.theta = 0;
    other.line({{10, 50}, {15, 50}});
    auto motion = test::motion({one.graph(), other.graph()}, {{{0, 0}, {1, 1}}});
    graph::link_skipped_patches(motion);
    return pairs(motion).size() == 3;
  };
  CHECK(linked({22.4, 50}));
  CHECK(!linked({22.6, 50}));
  CHECK(linked({15, 52.9}));
  CHECK(!linked({15, 53.1}));
  CHECK(linked({20, 52}));
  CHECK(!linked({20, 52.5}));  // both together: in an ellipse
}

TEST_CASE(
    "Nothing is linked with what lies elsewhere, is of another kind or turned, or beside no linked patch",
    "[graph][skipped_patches]") {
  test::Frame one, other;
  one.line({{10, 50}, {15, 50}, {20, 50}});
  one.line({{60, 50}, {65, 50}});
  other.line({{10, 50}, {15, 50}, {20, 50}});
  other.line({{60, 50}, {65, 50}});
  const Pairs two = {{0, 0}, {1, 1}};
  SECTION("elsewhere") {
    other.vertices[2].patch.position = {20, 56};
    // It may still join the middle one: that lies 5 px along the curve.
    auto motion = test::motion({one.graph(), other.graph()}, {two});
    graph::link_skipped_patches(motion);
    CHECK(pairs(motion) == Pairs{{0, 0}, {1, 1}, {2, 1}});
  }
  SECTION("another kind") {
    for (std::size_t v : {0, 1, 2}) other.vertices[v].patch.contrast *= -1;
    auto motion = test::motion({one.graph(), other.graph()}, {two});
    graph::link_skipped_patches(motion);
    CHECK(pairs(motion) == two);
  }
  SECTION("turned") {
    for (std::size_t v : {0, 1, 2}) other.vertices[v].patch.theta += 0.6;
    auto motion = test::motion({one.graph(), other.graph()}, {two});
    graph::link_skipped_patches(motion);
    CHECK(pairs(motion) == two);
  }
  SECTION("beside none") {
    auto motion = test::motion({one.graph(), other.graph()}, {{{0, 0}, {1, 1}, {2, 2}}});
    graph::link_skipped_patches(motion);
    CHECK(motion.skipped.empty());
  }
}

TEST_CASE("Skipped patches leave a star forest, and link no strokes that were not",
          "[graph][skipped_patches]") {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const auto motion = test::random_motion(seed, 5, 12);
    auto more = motion;
    graph::link_skipped_patches(more);
    REQUIRE_NOTHROW(graph::validate(more));
    CHECK(more.links == motion.links);
    // Written and read they stay apart.
    more = graph::identify(std::move(more));
    std::stringstream file;
    graph::write_motion(file, more);
    CHECK(graph::read_motion(file, "a test") == more);
    CHECK(graph::identify(more).sketch == graph::identify(motion).sketch);
  }
}
