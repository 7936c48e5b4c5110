// SPDX-License-Identifier: Apache-2.0
#include "graph/motion_graph.hpp"

#include <set>

#include "core/error.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;

namespace {
graph::AttributeGraph dots(std::uint32_t count) {
  test::Frame frame;
  for (std::uint32_t i = 0; i < count; ++i) frame.line({{20.0 * i, 0}});
  return frame.graph();
}
using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

bool is_valid(const graph::MotionGraph& motion) {
  return test::message_of<core::InputError>([&] { graph::validate(motion); }).empty();
}
}  // namespace

TEST_CASE("Frames that are appended are renumbered in their order", "[graph]") {
  test::Frame frame;
  frame.line(test::segment({0, 0}, {20, 0}, 3));
  graph::SketchSequence sketch;
  sketch.append(frame.graph());
  sketch.append({});
  sketch.append(frame.graph());
  const auto& last = sketch.frames[2];
  REQUIRE(last.size() == 3);
  CHECK(sketch.frames[0].vertices()[0].id.value == 0);
  CHECK(last.vertices()[0].id.value == 3);
  CHECK(last.edges()[1] == graph::Edge{{4}, {5}});
  CHECK(last.patch(2) == frame.graph().patch(2));
}

TEST_CASE("Exactly the star forests are valid: their number is known", "[graph]") {
  // All subsets of the complete bipartite graph, without a link whose ends both have partners.
  const auto count = [](std::uint32_t m, std::uint32_t n) {
    int valid = 0;
    for (std::uint32_t set = 0; set < 1U << (m * n); ++set) {
      Pairs links;
      for (std::uint32_t k = 0; k < m * n; ++k) {
        if ((set >> k) & 1U) links.emplace_back(k / n, k % n);
      }
      valid += is_valid(test::motion({dots(m), dots(n)}, {links})) ? 1 : 0;
    }
    return valid;
  };
  CHECK(count(1, 1) == 2);
  CHECK(count(2, 2) == 11);
  CHECK(count(2, 3) == 30);
  CHECK(count(3, 2) == 30);
  CHECK(count(3, 3) == 103);
}

TEST_CASE("A motion graph that is none is refused with frame and ids", "[graph]") {
  const auto good = test::motion({dots(2), dots(2)}, {{{0, 0}, {1, 1}}});
  REQUIRE(is_valid(good));
  const auto refusal = [&](auto spoil) {
    graph::MotionGraph bad = good;
    spoil(bad);
    return test::message_of<core::InputError>([&] { graph::validate(bad); });
  };
  CHECK(test::contains(refusal([](auto& m) { m.links.pop_back(); }), "1 lists of links for 2 frames"));
  CHECK(test::contains(refusal([](auto& m) { m.links[0] = m.links[1]; }), "frame 0"));
  CHECK(test::contains(refusal([](auto& m) { m.links[0] = m.links[1]; }), "no frame"));
  CHECK(test::contains(refusal([](auto& m) { m.links[1][0].before = {7}; }), "frame 1"));
  CHECK(test::contains(refusal([](auto& m) { m.links[1][0].before = {7}; }), "vertex 7"));
  CHECK(test::contains(refusal([](auto& m) { m.links[1][1].after = {1}; }), "to vertex 1 ends at a vertex"));
  CHECK(test::contains(refusal([](auto& m) { std::swap(m.links[1][0], m.links[1][1]); }), "sorted"));
  CHECK(test::contains(refusal([](auto& m) { m.links[1][1] = m.links[1][0]; }), "twice"));
  CHECK(test::contains(refusal([](auto& m) {
                         m.links[1].insert(m.links[1].begin() + 1, graph::Link{{0}, {3}});
                       }),
                       "link from vertex 0 to vertex 3"));
  CHECK(test::contains(refusal([](auto& m) {
                         m.links[1].insert(m.links[1].begin() + 1, graph::Link{{0}, {3}});
                       }),
                       "both of its ends"));
  CHECK(test::contains(refusal([](auto& m) { m.sketch.frames[1] = m.sketch.frames[0], m.links[1].clear(); }),
                       "frame 1"));
  CHECK(test::contains(refusal([](auto& m) { m.sketch.frames[1] = m.sketch.frames[0], m.links[1].clear(); }),
                       "vertex 0 is not above"));
}

TEST_CASE("A stroke keeps its identity until it splits or merges", "[graph]") {
  // A pair of strokes; one splits, the other goes on; then two of three merge; one dies and one is born.
  const auto frame = [](int strokes) {
    test::Frame f;
    for (int k = 0; k < strokes; ++k) f.line(test::segment({0, 20.0 * k}, {10, 20.0 * k}, 2));
    return f.graph();
  };
  const auto motion = graph::identify(test::motion(
      {frame(2), frame(2), frame(3), frame(2), frame(2)},
      {{{0, 0}, {2, 2}, {3, 3}}, {{0, 0}, {1, 2}, {2, 4}}, {{0, 0}, {2, 1}, {4, 2}}, {{2, 0}, {3, 1}}}));
  const auto ids = [&](std::size_t t) {
    std::vector<std::uint32_t> result;
    for (const auto& v : motion.sketch.frames[t].vertices()) result.push_back(v.subgraph.value);
    return result;
  };
  using Ids = std::vector<std::uint32_t>;
  CHECK(ids(0) == Ids{1, 1, 2, 2});
  CHECK(ids(1) == Ids{1, 1, 2, 2});
  CHECK(ids(2) == Ids{3, 3, 4, 4, 2, 2});
  CHECK(ids(3) == Ids{5, 5, 2, 2});
  CHECK(ids(4) == Ids{2, 2, 6, 6});
}

TEST_CASE("Identities are one for each component and stay exactly along lone ties", "[graph]") {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const auto motion = graph::identify(test::random_motion(seed, 4, 8));
    CHECK(graph::identify(motion) == motion);
    for (std::size_t t = 0; t < motion.sketch.frames.size(); ++t) {
      const auto& frame = motion.sketch.frames[t];
      const auto parts = graph::components(frame);
      for (std::size_t i = 0; i < frame.size(); ++i) {
        for (std::size_t j = 0; j < frame.size(); ++j) {
          CHECK((frame.vertices()[i].subgraph == frame.vertices()[j].subgraph) ==
                (parts.of_vertex[i] == parts.of_vertex[j]));
        }
      }
      if (t == 0) continue;
      const auto& past = motion.sketch.frames[t - 1];
      const auto past_parts = graph::components(past);
      std::set<std::pair<std::uint32_t, std::uint32_t>> ties;
      for (const auto& link : motion.links[t]) {
        ties.emplace(past_parts.of_vertex[past.index_of(link.before)],
                     parts.of_vertex[frame.index_of(link.after)]);
      }
      for (const auto& link : motion.links[t]) {
        const auto i = past.index_of(link.before), j = frame.index_of(link.after);
        std::size_t shared = 0;
        for (const auto& [a, b] : ties) shared += a == past_parts.of_vertex[i] || b == parts.of_vertex[j];
        CHECK((past.vertices()[i].subgraph == frame.vertices()[j].subgraph) == (shared == 1));
      }
    }
  }
}

TEST_CASE("Every vertex lies in one trajectory, and they are as long as can be", "[graph]") {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const auto motion = test::random_motion(seed, 5, 12);
    std::set<std::uint32_t> seen;
    std::size_t steps = 0, vertices = 0, stars = 0;
    graph::Trajectory last;
    for (const auto& course : graph::trajectories(motion)) {
      REQUIRE_FALSE(course.vertices.empty());
      if (!last.vertices.empty()) {
        CHECK(std::pair(last.first_frame, last.vertices[0]) <
              std::pair(course.first_frame, course.vertices[0]));
      }
      last = course;
      for (std::size_t k = 0; k < course.vertices.size(); ++k) {
        CHECK(seen.insert(course.vertices[k].value).second);
        if (k == 0) continue;
        ++steps;
        const auto& links = motion.links[static_cast<std::size_t>(course.first_frame) + k];
        CHECK(std::count(links.begin(), links.end(),
                         graph::Link{course.vertices[k - 1], course.vertices[k]}) == 1);
      }
    }
    for (const auto& frame : motion.sketch.frames) vertices += frame.size();
    // One trajectory goes on through each star, which has a link fewer than vertices.
    for (const auto& links : motion.links) {
      std::set<std::uint32_t> before, after;
      for (const auto& link : links) before.insert(link.before.value), after.insert(link.after.value);
      stars += before.size() + after.size() - links.size();
    }
    CHECK(seen.size() == vertices);
    CHECK(steps == stars);
  }
}

TEST_CASE("A motion graph holds no anchors", "[graph][anchors]") {
  core::Rng rng(3);
  auto motion = test::motion({dots(2), dots(3)}, {{{0, 0}}});
  motion.sketch.frames[1] = test::with_anchors(motion.sketch.frames[1], rng, 1);
  const auto refusal = test::message_of<core::InputError>([&] { graph::identify(motion); });
  CHECK(test::contains(refusal, "frame 1: vertex 5 is an anchor"));
}
