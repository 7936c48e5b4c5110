// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/hidden_graph.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <set>
#include <string>

#include "core/error.hpp"
#include "graph/matching/match.hpp"
#include "tests/mcmc/sampler/small_models.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/motion_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

/// All that operations may change, in the order in which it is kept.
std::vector<std::uint64_t> image(const HiddenGraph& g) {
  std::vector<std::uint64_t> all;
  const auto add = [&](const auto& list) {
    all.push_back(list.size());
    all.insert(all.end(), list.begin(), list.end());
  };
  for (int t = 0; t < g.frames(); ++t) add(g.active(t)), add(g.inactive(t));
  for (Index i = 0; i < g.size(); ++i) {
    const auto& node = g[i];
    all.push_back(node.active);
    all.push_back(node.overlapped);
    all.push_back(std::bit_cast<std::uint64_t>(node.displacement));
    add(node.edges), add(node.next), add(node.prev);
    all.push_back(g.neighbours(i).size());
    for (const auto& near : g.neighbours(i)) all.push_back(near.node), all.push_back(near.closeness);
    for (const Index to : g.candidates_after(i)) all.push_back(to);
    add(g.candidates_before(i));
  }
  return all;
}

/// Candidates of all kinds all over, some outside the frame.
HiddenGraph strewn(std::uint32_t number, const Gates& gates, int frames = 3, int count = 90) {
  core::Rng rng(3, {number, 0, 0});
  HiddenGraph g(50, 40, frames, gates);
  for (int k = 0; k < count; ++k) {
    auto p = patch(rng.uniform(-12, 62), rng.uniform(-12, 52), rng.uniform(-3, 3),
                   rng.uniform(10, 20) * (rng.below(3) == 0 ? -1 : 1));
    if (rng.below(4) == 0) p.width = 0;
    g.add_candidate(static_cast<int>(rng.below(static_cast<std::uint32_t>(frames))), p);
  }
  return g;
}

/// One operation that may be done, at random; what takes it back; nothing where none was found.
std::function<void()> operate(HiddenGraph& g, core::Rng& rng) {
  const auto any = [&](std::size_t n) {
    return static_cast<Index>(rng.below(static_cast<std::uint32_t>(n)));
  };
  const Index i = any(g.size());
  switch (rng.below(6)) {
    case 0:
      if (!g.can_activate(i)) return {};
      return [&g, i, at = g.inactive_place(i), done = (g.activate(i), true)] { g.undo_activate(i, at); };
    case 1:
      if (!g[i].active || !g[i].edges.empty() || !g[i].next.empty() || !g[i].prev.empty()) return {};
      return [&g, i, at = g.deactivate(i)] { g.undo_deactivate(i, at); };
    case 2:
      for (const auto& near : g.neighbours(i))
        if (rng.below(2) == 0 && g.can_add_edge(i, near.node))
          return [&g, i, j = near.node, done = (g.add_edge(i, near.node), true)] { g.remove_edge(i, j); };
      return {};
    case 3: {
      if (g[i].edges.empty()) return {};
      const Index j = g[i].edges[any(g[i].edges.size())];
      return [&g, i, j, at = g.remove_edge(i, j)] { g.undo_remove_edge(i, j, at); };
    }
    case 4:
      for (const Index to : g.candidates_after(i))
        if (const Index w = to; rng.below(2) == 0 && g.can_link(i, w))
          return [&g, i, w, done = (g.link(i, w), true)] { g.unlink(i, w); };
      return {};
    default: {
      if (g[i].next.empty()) return {};
      const Index w = g[i].next[any(g[i].next.size())];
      return [&g, i, w, at = g.unlink(i, w)] { g.undo_unlink(i, w, at); };
    }
  }
}

/// True if every link has an end without another link.
bool star_forest(const HiddenGraph& g) {
  for (Index i = 0; i < g.size(); ++i)
    for (const Index w : g[i].next)
      if (g[i].next.size() > 1 && g[w].prev.size() > 1) return false;
  return true;
}

}  // namespace

TEST_CASE("A hidden graph's operations are taken back bit by bit", "[mcmc][hidden_graph]") {
  for (std::uint32_t number = 0; number < 20; ++number) {
    HiddenGraph g = strewn(number, {12, 12, number % 2 == 0 ? 0.0 : 4.0});
    core::Rng rng(4, {number, 0, 0});
    for (int n = 0; n < 400; ++n) operate(g, rng);  // somewhere in the middle
    for (int round = 0; round < 20; ++round) {
      const auto was = image(g);
      const auto hash = g.hash();
      const HiddenGraph copy = g;
      std::vector<std::function<void()>> undo;
      std::size_t different = 0;
      for (int n = 0; n < 80; ++n)
        if (auto back = operate(g, rng)) {
          undo.push_back(std::move(back));
          different += g.hash() != hash;
          REQUIRE((g.hash() == hash) == (g == copy));
        }
      REQUIRE(undo.size() > 3);
      CHECK(different > 0);
      for (auto back = undo.rbegin(); back != undo.rend(); ++back) (*back)();
      REQUIRE(image(g) == was);
      REQUIRE(g.hash() == hash);
      REQUIRE(g == copy);
      for (int n = 0; n < 40; ++n) operate(g, rng);
    }
  }
}

TEST_CASE("Equal states are equal whatever the order in which they came about", "[mcmc][hidden_graph]") {
  const auto make = [](bool other_way) {
    HiddenGraph g(60, 60, 2, {12, 12, 0});
    for (int k = 0; k < 3; ++k) g.add_candidate(0, patch(20 + 4 * k, 20));
    for (int k = 0; k < 3; ++k) g.add_candidate(1, patch(20 + 4 * k, 21));
    for (int k = 0; k < 6; ++k) g.activate(static_cast<Index>(other_way ? 5 - k : k));
    if (other_way) {
      g.add_edge(2, 1), g.add_edge(0, 1), g.link(1, 5), g.link(1, 4), g.link(0, 3);
    } else {
      g.add_edge(0, 1), g.add_edge(1, 2), g.link(0, 3), g.link(1, 4), g.link(1, 5);
    }
    g.set_displacement(4, 0.25);
    return g;
  };
  const auto a = make(false), b = make(true);
  CHECK(a == b);
  CHECK(a.hash() == b.hash());
  for (const int change : {0, 1, 2, 3}) {
    auto c = b;
    if (change == 0) c.remove_edge(0, 1);
    if (change == 1) c.unlink(1, 4);
    if (change == 2) c.set_displacement(4, 0.5);
    if (change == 3) c.unlink(0, 3), c.deactivate(3);
    CHECK(!(c == a));
    CHECK(c.hash() != a.hash());
  }
  auto c = b;
  c.set_displacement(4, -0.0), c.set_displacement(4, 0.25), c.set_displacement(3, -0.0);
  CHECK(c.hash() == a.hash());
}

TEST_CASE("What lies near is what brute force finds", "[mcmc][hidden_graph]") {
  for (const Gates gates : {Gates{12, 12, 3}, Gates{5, 14, 3}, Gates{9, 2, 0}, Gates{100, 100, 0}}) {
    const HiddenGraph g = strewn(7, gates);
    for (Index i = 0; i < g.size(); ++i) {
      std::set<Index> beside, ahead, behind;
      for (Index j = 0; j < g.size(); ++j) {
        const double distance = graph::distance(g[i].patch.position, g[j].patch.position);
        if (i != j && g[i].frame == g[j].frame && distance <= gates.edge) beside.insert(j);
        if (g[i].kind != g[j].kind || distance > gates.link) continue;
        if (g[j].frame == g[i].frame + 1) ahead.insert(j);
        if (g[j].frame == g[i].frame - 1) behind.insert(j);
      }
      std::set<Index> found;
      for (const auto& near : g.neighbours(i)) {
        found.insert(near.node);
        const auto& back = g.neighbours(near.node);
        const auto mirror = std::ranges::find(back, i, &mcmc::NeighbourCandidate::node);
        REQUIRE(mirror != back.end());
        CHECK(mirror->closeness == near.closeness);
      }
      CHECK(found == beside);
      CHECK(found.size() == g.neighbours(i).size());
      std::set<Index> reached;
      for (const Index to : g.candidates_after(i)) reached.insert(to);
      CHECK(reached == ahead);
      CHECK(std::set<Index>(g.candidates_before(i).begin(), g.candidates_before(i).end()) == behind);
    }
  }
}

TEST_CASE("Closeness tells how far and whether in line", "[mcmc][hidden_graph]") {
  const auto of = [](double x, double y, double theta) {
    HiddenGraph g(60, 60, 1, {12, 12, 0});
    g.add_candidate(0, patch(20, 20, 0));
    g.add_candidate(0, patch(20 + x, 20 + y, theta));
    return int{g.neighbours(0)[0].closeness};
  };
  CHECK(of(6.9, 0, 0.4) == 0);
  CHECK(of(-6.9, 0, 0.4 + std::numbers::pi) == 0);
  CHECK(of(6.9, 0, 0.6) == 1);  // 34°
  CHECK(of(4, 4, 0) == 1);
  CHECK(of(0, 5, 0) == 1);
  CHECK(of(7.1, 0, 0) == 2);
  CHECK(of(0, 9.4, 0) == 3);
  CHECK(of(11, 0, 0) == 4);
  CHECK(of(0, 11, 0) == 5);
}

TEST_CASE("The newest candidate is taken back without a trace", "[mcmc][hidden_graph]") {
  HiddenGraph g = strewn(9, {12, 12, 4});
  core::Rng rng(8, {0, 0, 0});
  for (int n = 0; n < 500; ++n) operate(g, rng);
  const auto was = image(g);
  for (int round = 0; round < 3; ++round)
    for (int t = 0; t < 3; ++t) {
      const Index i = g.add_candidate(t, patch(20 + 3 * round, 20, 0.4));
      CHECK(i + 1 == g.size());
      if (g.can_activate(i) && round == 2) g.activate(i), g.deactivate(i);
      g.drop_newest_candidate();
      REQUIRE(image(g) == was);
    }
}

TEST_CASE("Overlaps are counted among patches of one kind that are on", "[mcmc][hidden_graph]") {
  for (std::uint32_t number = 0; number < 5; ++number) {
    HiddenGraph g = strewn(20 + number, {12, 12, 5});
    core::Rng rng(6, {number, 0, 0});
    std::size_t refused = 0;
    for (int n = 0; n < 600; ++n) {
      operate(g, rng);
      if (n % 60 != 59) continue;
      for (Index i = 0; i < g.size(); ++i) {
        int count = 0;
        for (Index j = 0; j < g.size(); ++j)
          count += i != j && g[j].active && g[i].frame == g[j].frame && g[i].kind == g[j].kind &&
                   graph::distance(g[i].patch.position, g[j].patch.position) < 5;
        CHECK(int{g[i].overlapped} == count);
        CHECK(g.can_activate(i) == (!g[i].active && count == 0));
        if (g[i].active) CHECK(count == 0);
        refused += !g[i].active && count > 0;
      }
    }
    CHECK(refused > 0);
  }
}

TEST_CASE("Links that can be made are those that leave a star forest", "[mcmc][hidden_graph]") {
  core::Rng rng(5, {0, 0, 0});
  HiddenGraph g(60, 60, 2, {20, 40, 0});
  for (int t = 0; t < 2; ++t)
    for (int k = 0; k < 5; ++k) shown(g, t, patch(20 + 2 * k, 20 + t));
  std::size_t yes = 0, no = 0;
  for (int n = 0; n < 3000; ++n) {
    const Index v = rng.below(5), w = 5 + rng.below(5);
    if (g[v].next.has(w)) {
      CHECK(!g.can_link(v, w));
      if (rng.below(2) == 0) g.unlink(v, w);
      continue;
    }
    const bool can = g.can_link(v, w);
    g.link(v, w);
    CHECK(can == star_forest(g));
    ++(can ? yes : no);
    if (!can) g.unlink(v, w);
  }
  CHECK(yes > 300);
  CHECK(no > 300);
  CHECK(!g.can_link(5, 0));
  CHECK(!g.can_link(0, 1));
  HiddenGraph off(60, 60, 2, {12, 12, 0});
  shown(off, 0, patch(20, 20)), off.add_candidate(1, patch(20, 21));
  CHECK(!off.can_link(0, 1));
}

TEST_CASE("No patch takes more edges or links than there is room for", "[mcmc][hidden_graph]") {
  HiddenGraph g(60, 60, 2, {20, 40, 0});
  const Index v = shown(g, 0, patch(30, 30));
  for (int k = 0; k < 20; ++k) {
    const double a = 0.3 * k;
    const Index x = shown(g, 0, patch(30 + 6 * std::cos(a), 30 + 6 * std::sin(a)));
    const Index y = shown(g, 1, patch(30 + 6 * std::cos(a), 30 + 6 * std::sin(a)));
    CHECK(g.can_add_edge(v, x) == (k < static_cast<int>(mcmc::kMostEdges)));
    CHECK(g.can_add_edge(x, v) == g.can_add_edge(v, x));
    CHECK(g.can_link(v, y) == (k < static_cast<int>(mcmc::kMostLinks)));
    if (g.can_add_edge(v, x)) g.add_edge(v, x);
    if (g.can_link(v, y)) g.link(v, y);
  }
  CHECK(g[v].edges.size() == mcmc::kMostEdges);
  CHECK(g[v].next.size() == mcmc::kMostLinks);
}

TEST_CASE("A matched clip becomes a state and again the same clip", "[mcmc][hidden_graph]") {
  test::Scene scene;
  scene.width = 160, scene.height = 120, scene.frames = 8;
  scene.strokes = test::living(1, 0.1, 8, 160, 120, 4);
  scene.displacement = {1.5, -0.7, 0.4, 30};
  const auto motion = test::make(scene, 5).motion;
  const auto state = mcmc::hidden_graphs({&motion, 1}, {}).front();
  CHECK(mcmc::motion_graph(state, motion.sketch.fps) == motion);

  // Matched by the matcher, with what a matcher would make of it.
  const auto matched = graph::match(motion.sketch, {});
  const auto of_match = mcmc::hidden_graphs({&matched, 1}, {}).front();
  const auto back = mcmc::motion_graph(of_match, matched.sketch.fps);
  REQUIRE(back.links == matched.links);
  CHECK(back == graph::identify(matched));
}

TEST_CASE("States of several starts have the candidates of all, and each is its own start",
          "[mcmc][hidden_graph]") {
  test::Scene scene;
  scene.width = 160, scene.height = 120, scene.frames = 5;
  scene.strokes = test::scattered(3, 2, 160, 120, 50);
  std::vector<graph::MotionGraph> starts = {test::make(scene, 5).motion};
  scene.strokes = test::scattered(3, 3, 160, 120, 40);
  starts.push_back(test::make(scene, 6).motion), starts.push_back(test::make(scene, 7).motion);
  const Gates gates{12, 12, 3};
  const auto states = mcmc::hidden_graphs(starts, gates);
  REQUIRE(states.size() == 3);
  CHECK(mcmc::motion_graph(states[0], starts[0].sketch.fps) == starts[0]);
  std::size_t expected = 0;
  for (std::size_t t = 0; t < starts[0].sketch.frames.size(); ++t) {
    std::vector<graph::Point> known;
    for (const auto& start : starts) {
      const auto before = known;  // those of one start may lie beside each other
      for (const auto& v : start.sketch.frames[t].vertices())
        if (std::ranges::none_of(
                before, [&](graph::Point p) { return graph::distance(p, v.patch.position) < gates.overlap; }))
          known.push_back(v.patch.position), ++expected;
    }
  }
  for (std::size_t k = 0; k < states.size(); ++k) {
    const HiddenGraph& g = states[k];
    CHECK(g.size() >= expected);  // more: two patches of a start may overlap one candidate
    CHECK(g.size() <= expected + expected / 10);
    std::size_t on = 0, edges = 0, links = 0;
    for (Index i = 0; i < g.size(); ++i) {
      CHECK(g[i].patch.position == states[0][i].patch.position);
      on += g.is_active(i), edges += g[i].edges.size(), links += g[i].next.size();
    }
    std::size_t patches = 0, joined = 0, linked = 0;
    for (std::size_t t = 0; t < starts[k].sketch.frames.size(); ++t)
      patches += starts[k].sketch.frames[t].vertices().size(),
          joined += 2 * starts[k].sketch.frames[t].edges().size(), linked += starts[k].links[t].size();
    CHECK(on == patches);
    CHECK(edges == joined);
    CHECK(links == linked);
  }
}

TEST_CASE("Patches of one start may overlap, in the states of all starts", "[mcmc][hidden_graph]") {
  const auto clip_of = [](const std::vector<double>& places) {
    std::vector<graph::Vertex> vertices;
    for (const double x : places)
      vertices.push_back({{static_cast<std::uint32_t>(vertices.size())}, {}, patch(x, 30)});
    graph::MotionGraph motion;
    motion.sketch.width = motion.sketch.height = 60;
    motion.sketch.append(graph::AttributeGraph(std::move(vertices), {}));
    motion.links.emplace_back();
    return motion;
  };
  // The first two of each start overlap each other.
  const std::vector<graph::MotionGraph> starts = {clip_of({10, 12, 20}), clip_of({12.5, 13, 18})};
  const auto states = mcmc::hidden_graphs(starts, {12, 12, 3});
  REQUIRE(states[0].size() == 4);  // a candidate is of one patch of a start
  CHECK(states[0].active(0).size() == 3);
  CHECK((states[1].is_active(1) && states[1].is_active(2) && states[1].is_active(3)));
  CHECK(states[1].can_activate(0));  // beside its overlapping neighbour, as in the first start
}

TEST_CASE("Edges and links beyond the gates stay where the start has them", "[mcmc][hidden_graph]") {
  auto motion = test::make({.width = 160,
                            .height = 120,
                            .frames = 4,
                            .strokes = test::scattered(2, 2, 160, 120, 40),
                            .displacement = {1.5, -0.7, 0.4, 30},
                            .gain = {},
                            .drift =
                                [](graph::Point) {
                                  return graph::Point{2.5, 0};
                                }},
                           3)
                    .motion;
  const auto state = mcmc::hidden_graphs({&motion, 1}, {2, 1, 0}).front();
  CHECK(mcmc::motion_graph(state, motion.sketch.fps) == motion);
}

TEST_CASE("Starts of different clips are refused", "[mcmc][hidden_graph]") {
  test::Scene scene;
  scene.width = 80, scene.height = 60, scene.frames = 3;
  scene.strokes = test::scattered(1, 1, 80, 60, 30);
  const auto start = test::make(scene, 1).motion;
  auto wider = start, longer = start;
  wider.sketch.width = 81;
  longer.sketch.append(longer.sketch.frames.back()), longer.links.emplace_back();
  for (const auto& other : {wider, longer})
    REQUIRE_THROWS_AS(mcmc::hidden_graphs(std::vector{start, other}, {}), core::InputError);
  REQUIRE_THROWS_AS(mcmc::hidden_graphs({}, {}), core::InputError);
  REQUIRE_NOTHROW(mcmc::hidden_graphs(std::vector{start, start}, {}));
}

TEST_CASE("Kinds are told by contrast and core", "[mcmc][hidden_graph]") {
  CHECK(mcmc::kind(patch(0, 0, 0, 5)) == mcmc::Kind::bright);
  CHECK(mcmc::kind(patch(0, 0, 0, -5)) == mcmc::Kind::dark);
  CHECK(mcmc::kind(test::step_patch(0, 0, 0, 5)) == mcmc::Kind::step);
  CHECK(mcmc::kind(test::step_patch(0, 0, 0, -5)) == mcmc::Kind::step);
}
