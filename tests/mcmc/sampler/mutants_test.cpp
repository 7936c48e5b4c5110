// SPDX-License-Identifier: Apache-2.0
// Six wrong ratios, as they are easily written (old-state counts, a forgotten factor): the checker must not
// let any of them pass. Each is a right move, wrapped.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>

#include "tests/mcmc/sampler/small_models.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;
using mcmc::CheckedMove;
using mcmc::ChoiceSource;

namespace {

/// Error to be added to the log ratio, by the states before and after.
using Fault = std::function<double(const HiddenGraph& was, const HiddenGraph& is, int frame)>;

CheckedMove with_fault(std::string_view name, Fault fault) {
  return [right = test::checked(test::move_named(name)), fault = std::move(fault)](
             StateChange& change, ChoiceSource& draws, int frame) -> std::optional<double> {
    const HiddenGraph was = change.state();
    const auto ratio = right(change, draws, frame);
    if (!ratio || was == change.state()) return ratio;
    return *ratio + fault(was, change.state(), frame);
  };
}

double log_count(std::size_t n) {
  return std::log(static_cast<double>(std::max<std::size_t>(n, 1)));
}
/// As the moves have it: of an edge of which either end may be drawn first.
double log_either(std::size_t m, std::size_t n) {
  const auto part = [](std::size_t k) { return 1 / static_cast<double>(std::max<std::size_t>(k, 1)); };
  return std::log(part(m) + part(n));
}

/// The edge, or link, that one state has and the other has not.
struct Tie {
  Index a = 0, b = 0;
};
Tie new_edge(const HiddenGraph& less, const HiddenGraph& more) {
  for (Index i = 0; i < more.size(); ++i)
    for (const Index j : more[i].edges)
      if (!less[i].edges.has(j)) return {i, j};
  throw std::logic_error("no edge is new");
}
Tie new_link(const HiddenGraph& less, const HiddenGraph& more) {
  for (Index i = 0; i < more.size(); ++i)
    for (const Index j : more[i].next)
      if (!less[i].next.has(j)) return {i, j};
  throw std::logic_error("no link is new");
}
std::size_t count_on(const HiddenGraph& g) {
  std::size_t count = 0;
  for (int t = 0; t < g.frames(); ++t) count += g.active(t).size();
  return count;
}
std::size_t joinable(const HiddenGraph& g, Index a) {
  return static_cast<std::size_t>(
      std::ranges::count_if(g.neighbours(a), [&](const auto& b) { return g.can_add_edge(a, b.node); }));
}
std::size_t linkable(const HiddenGraph& g, Index v) {
  return static_cast<std::size_t>(
      std::ranges::count_if(g.candidates_after(v), [&](Index to) { return g.can_link(v, to); }));
}

/// Number of edges and pasts that the added patch could get from the patch that was split.
std::size_t shares(const HiddenGraph& one, const HiddenGraph& two) {
  Index i = 0;
  while (one[i].active || !two[i].active) ++i;
  const auto gated = [&](Index a, Index b) {
    return std::ranges::any_of(one.neighbours(a), [&](const auto& near) { return near.node == b; });
  };
  for (const Index v : two[i].edges) {
    const bool whole = std::ranges::all_of(
        two[i].edges, [&](Index x) { return x == v || (one[v].edges.has(x) && !two[v].edges.has(x)); });
    if (!whole) continue;
    auto count =
        static_cast<std::size_t>(std::ranges::count_if(one[v].edges, [&](Index x) { return gated(i, x); }));
    if (one[v].prev.size() == 1) {
      count += one.linkable(one[v].prev[0], i);
    }
    return count;
  }
  throw std::logic_error("nothing was split");
}

/// A row of three and one beyond, in two frames; candidates between them: splits, merges, births and deaths.
HiddenGraph rows() {
  HiddenGraph g(60, 60, 2, {8, 12, 0});
  const Index v = shown(g, 1, patch(30, 30));
  for (const auto& [x, y] : {std::pair{35.0, 30.0}, {25.0, 30.0}, {30.0, 35.0}, {30.0, 25.0}})
    g.add_edge(v, shown(g, 1, patch(x, y, 0.1, -20)));
  g.link(shown(g, 0, patch(30, 31)), v);
  g.add_candidate(1, patch(31, 31, 0.3));
  g.add_candidate(1, patch(28, 31, 0.2));
  test::furnish(g);
  return g;
}
/// Two and two patches near each other.
HiddenGraph pairs() {
  HiddenGraph g(60, 60, 2, {12, 12, 0});
  for (int t = 0; t < 2; ++t) {
    g.add_candidate(t, patch(20 + t, 20)), g.add_candidate(t, patch(25, 20 + t, 0.3));
  }
  test::furnish(g);
  return g;
}
/// Three patches in a frame that may be joined; they are there.
HiddenGraph corner() {
  HiddenGraph g(60, 60, 1, {12, 12, 0});
  test::row(g, 0, 3, 20, 20, false);
  shown(g, 0, patch(24, 25));
  test::furnish(g);
  return g;
}
/// Three before and three after: all splits and merges among them.
HiddenGraph crowd() {
  HiddenGraph g(60, 60, 2, {12, 12, 0});
  for (int t = 0; t < 2; ++t) {
    shown(g, t, patch(20, 20 + t)), shown(g, t, patch(23, 20)), shown(g, t, patch(22, 23));
  }
  test::furnish(g);
  return g;
}

/// The right move passes on the model, and the wrong one does not.
void require_caught(const HiddenGraph& model, std::string_view name, const Fault& fault) {
  const mcmc::Density density(test::even_theta());
  const auto right = check_ratios(model, density, {test::checked(test::move_named(name))});
  REQUIRE(right.complete);
  REQUIRE(right.transitions > 0);
  REQUIRE(right.worst_ratio <= 1e-10);
  REQUIRE(right.worst_balance <= 1e-14);
  const auto wrong = check_ratios(model, density, {with_fault(name, fault)});
  REQUIRE(wrong.transitions == right.transitions);
  CHECK(wrong.worst_ratio > 1e-3);
  CHECK(wrong.worst_balance > 1e-9);
}

}  // namespace

TEST_CASE("The checker catches a split that forgets in how many ways edges are shared", "[mcmc][mutants]") {
  require_caught(rows(), "split, merge", [](const HiddenGraph& was, const HiddenGraph& is, int) {
    const bool split = count_on(is) > count_on(was);
    const auto ways = static_cast<double>(split ? shares(was, is) : shares(is, was));
    return (split ? -1 : 1) * ways * std::numbers::ln2;
  });
}

TEST_CASE("The checker catches a split twice as likely as it should be", "[mcmc][mutants]") {
  require_caught(rows(), "split, merge", [](const HiddenGraph& was, const HiddenGraph& is, int) {
    return (count_on(is) > count_on(was) ? 1 : -1) * std::numbers::ln2;
  });
}

TEST_CASE("The checker catches a connect that counts in the old state", "[mcmc][mutants]") {
  require_caught(corner(), "connect, cut", [](const HiddenGraph& was, const HiddenGraph& is, int) {
    const bool connect =
        was[0].edges.size() + was[1].edges.size() + was[2].edges.size() + was[3].edges.size() <
        is[0].edges.size() + is[1].edges.size() + is[2].edges.size() + is[3].edges.size();
    const Tie tie = connect ? new_edge(was, is) : new_edge(is, was);
    const auto back = [&](const HiddenGraph& g) {
      return connect ? log_either(g[tie.a].edges.size(), g[tie.b].edges.size())
                     : log_either(joinable(g, tie.a), joinable(g, tie.b));
    };
    return back(was) - back(is);
  });
}

TEST_CASE("The checker catches a link that counts in the old state", "[mcmc][mutants]") {
  require_caught(crowd(), "link, unlink", [](const HiddenGraph& was, const HiddenGraph& is, int) {
    std::size_t before = 0, after = 0;
    for (Index i = 0; i < was.size(); ++i) before += was[i].next.size(), after += is[i].next.size();
    const bool link = after > before;
    const Index v = (link ? new_link(was, is) : new_link(is, was)).a;
    const auto back = [&](const HiddenGraph& g) {
      return -log_count(link ? g[v].next.size() : linkable(g, v));
    };
    return back(was) - back(is);
  });
}

TEST_CASE("The checker catches births and deaths that count in the old state", "[mcmc][mutants]") {
  require_caught(pairs(), "add, delete", [](const HiddenGraph& was, const HiddenGraph& is, int frame) {
    const bool add = count_on(is) > count_on(was);
    const auto back = [&](const HiddenGraph& g) {
      return -log_count(add ? g.active(frame).size() : g.inactive(frame).size());
    };
    return back(was) - back(is);
  });
}

TEST_CASE("The checker catches births and deaths that leave their chances out", "[mcmc][mutants]") {
  const mcmc::Density density(test::even_theta());
  const auto right = test::checked(test::move_named("add, delete"));
  REQUIRE(check_ratios(pairs(), density, {right}).worst_ratio <= 1e-10);
  const CheckedMove wrong = [&](StateChange& change, ChoiceSource& draws,
                                int frame) -> std::optional<double> {
    if (!right(change, draws, frame)) return std::nullopt;
    return 0;
  };
  const auto caught = check_ratios(pairs(), density, {wrong});
  REQUIRE(caught.transitions > 0);
  CHECK(caught.worst_ratio > 1e-3);
  CHECK(caught.worst_balance > 1e-9);
}

TEST_CASE("The checker catches a way there that has no way back", "[mcmc][mutants]") {
  const mcmc::Density density(test::even_theta());
  const auto right = test::checked(test::move_named("add, delete"));
  const CheckedMove only_add = [&](StateChange& change, ChoiceSource& draws,
                                   int frame) -> std::optional<double> {
    const std::size_t count = change.state().active(frame).size();
    const auto ratio = right(change, draws, frame);
    if (ratio && change.state().active(frame).size() > count) return ratio;
    return std::nullopt;
  };
  // The checker's draws undo what a move leaves behind.
  CHECK(std::isinf(check_ratios(pairs(), density, {only_add}).worst_ratio));
}
