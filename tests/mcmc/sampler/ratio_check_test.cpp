// SPDX-License-Identifier: Apache-2.0
// Claimed ratios of every move, from every state of small models, compared with sums over its draws.
#include "mcmc/sampler/ratio_check.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "tests/mcmc/sampler/small_models.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;
using mcmc::CheckedMove;
using mcmc::RatioReport;

namespace {

constexpr Gates kWide{12, 12, 0};

HiddenGraph three_frames() {
  HiddenGraph g(60, 60, 3, kWide);
  g.add_candidate(0, patch(20, 20)), g.add_candidate(0, patch(25, 21, 0.3));
  g.add_candidate(1, patch(21, 22)), g.add_candidate(1, patch(26, 20, 3.0));
  g.add_candidate(2, patch(22, 21));
  test::furnish(g);
  return g;
}

HiddenGraph three_and_three() {
  HiddenGraph g(60, 60, 2, kWide);
  g.add_candidate(0, patch(20, 20)), g.add_candidate(0, patch(25, 21, 0.3));
  g.add_candidate(0, patch(23, 25));
  g.add_candidate(1, patch(21, 22)), g.add_candidate(1, patch(26, 20, 3.0));
  g.add_candidate(1, patch(24, 24));
  test::furnish(g);
  return g;
}

/// Bright, dark and steps, at the frame's border, some of which overlap: not all may be on together.
HiddenGraph mixed() {
  HiddenGraph g(30, 30, 2, {12, 12, 3});
  g.add_candidate(0, patch(5, 5)), g.add_candidate(0, patch(7, 5, 0.2));
  g.add_candidate(0, patch(9, 9, 0.4, -15)), g.add_candidate(0, test::step_patch(6, 6, 1.1));
  g.add_candidate(1, patch(6, 5, 3.2)), g.add_candidate(1, patch(10, 8, 0.5, -14));
  g.add_candidate(1, patch(11, 9, 0.4, -18));
  test::furnish(g);
  return g;
}

/// A patch with four neighbours of another kind and two candidates beside it, which it can share its edges
/// with, and its past.
HiddenGraph fan() {
  HiddenGraph g(60, 60, 2, {11, 12, 0});
  const Index past = shown(g, 0, patch(30, 31));
  const Index v = shown(g, 1, patch(30, 30));
  for (const auto& [x, y] : {std::pair{35.0, 30.0}, {25.0, 30.0}, {30.0, 35.0}, {30.0, 25.0}})
    g.add_edge(v, shown(g, 1, patch(x, y, 0.1, -20)));
  g.add_candidate(1, patch(31, 31, 0.3));
  g.add_candidate(1, patch(28, 31, 0.2));
  g.link(past, v);
  test::furnish(g);
  return g;
}

/// A stroke of four in each of two frames: runs of links.
HiddenGraph two_rows(int count) {
  HiddenGraph g(60, 60, 2, kWide);
  test::row(g, 0, count, 20, 20), test::row(g, 1, count, 20, 21);
  test::furnish(g);
  return g;
}

/// Two strokes before, one after between them.
HiddenGraph heirs() {
  HiddenGraph g(60, 60, 2, {6, 12, 0});
  test::row(g, 0, 3, 20, 20), test::row(g, 0, 2, 20, 27);
  test::row(g, 1, 3, 20, 23);
  test::furnish(g);
  return g;
}

/// A ring of four in both frames.
HiddenGraph rings() {
  HiddenGraph g(60, 60, 2, kWide);
  for (int t = 0; t < 2; ++t) {
    std::vector<Index> ring;
    for (const auto& [x, y] : {std::pair{20.0, 20.0}, {25.0, 20.0}, {25.0, 25.0}, {20.0, 25.0}})
      ring.push_back(shown(g, t, patch(x + t, y)));
    for (std::size_t k = 0; k < 4; ++k) g.add_edge(ring[k], ring[(k + 1) % 4]);
  }
  test::furnish(g);
  return g;
}

/// Two patches of the first frame lie so far apart that neither can merge into the other, but both into a
/// third. So not every star forest is possible.
HiddenGraph apart() {
  HiddenGraph g(60, 60, 2, {8.2, 14, 0});
  const auto at = [](double ahead, double aside) {
    return patch(30 + 0.8 * ahead - 0.6 * aside, 30 + 0.6 * ahead + 0.8 * aside);
  };
  shown(g, 0, at(-1, 0)), shown(g, 0, at(-2, 0)), shown(g, 0, at(0, 4)), shown(g, 0, at(0, -4));
  shown(g, 0, at(-9.5, 0));
  shown(g, 1, at(0, 0)), shown(g, 1, at(-3, 0));
  test::furnish(g);
  return g;
}

/// Counts the changes of a move, and the links of its longest change.
struct Use {
  std::size_t times = 0, most_links = 0;
};
std::size_t links_changed(const HiddenGraph& a, const HiddenGraph& b) {
  std::size_t count = 0;
  for (Index i = 0; i < a.size(); ++i)
    count += static_cast<std::size_t>(
        std::ranges::count_if(a[i].next, [&](Index j) { return !b[i].next.has(j); }));
  return count;
}

std::vector<CheckedMove> all_but(const std::vector<std::string_view>& left_out = {}) {
  std::vector<CheckedMove> moves;
  for (const auto& move : mcmc::moves())
    if (std::ranges::find(left_out, move.name) == left_out.end()) moves.push_back(test::checked(move));
  return moves;
}
const std::vector<std::string_view> kPatchMoves = {"add, delete", "add, delete tracks", "split, merge"};
const std::vector<std::string_view> kAllButLinks = {"add, delete", "add, delete tracks", "split, merge",
                                                    "connect, cut"};

void require_right(const RatioReport& r) {
  INFO(r.states << " states, " << r.transitions << " transitions, ratio " << r.worst_ratio << ", balance "
                << r.worst_balance << ", gain " << r.worst_gain << ", " << r.classes << " classes");
  REQUIRE(r.complete);
  REQUIRE(r.transitions > 0);
  CHECK(r.worst_ratio <= 1e-10);
  CHECK(r.worst_balance <= 1e-14);
  CHECK(r.worst_gain <= 1e-10);
  CHECK(r.restored);
}

void require_right_together(const HiddenGraph& start, const Density& density,
                            const std::vector<CheckedMove>& moves, std::size_t at_least) {
  const auto r = check_ratios(start, density, moves, 60000);
  require_right(r);
  CHECK(r.classes == 1);
  CHECK(r.states >= at_least);
}

/// The state after some moves at random, that there be links, edges and patches to work on.
HiddenGraph stirred(HiddenGraph g, const Density& density, const std::vector<CheckedMove>& moves,
                    std::uint32_t number, int times) {
  core::Rng rng(5, {number, 0, 0});
  mcmc::FactorCache cache;
  cache.resize(g.size());
  mcmc::StateChange change(g, density, cache);
  mcmc::RandomChoices draws(rng);
  for (int n = 0; n < times; ++n) {
    const int frame = static_cast<int>(draws.below(static_cast<std::size_t>(g.frames())));
    const auto ratio = moves[draws.below(moves.size())](change, draws, frame);
    if (ratio && std::isfinite(change.gain())) change.commit();
    change.rollback();
  }
  for (int t = 0; t < g.frames(); ++t)
    for (const Index i : g.active(t)) g.set_displacement(i, 0);  // as the checker's draws have it
  return g;
}

}  // namespace

TEST_CASE("Ratios hold over three frames", "[mcmc][ratios][heavy]") {
  require_right_together(three_frames(), Density(test::even_theta()), all_but(), 398);
}

TEST_CASE("Ratios hold among ten thousand states", "[mcmc][ratios][heavy]") {
  require_right_together(three_and_three(), Density(test::even_theta()), all_but(), 10000);
}

TEST_CASE("Ratios hold among all kinds at the border where patches overlap", "[mcmc][ratios][heavy]") {
  require_right_together(mixed(), Density(test::even_theta()), all_but(), 500);
}

TEST_CASE("Ratios hold where a patch shares four edges with two candidates", "[mcmc][ratios][heavy]") {
  const std::vector<CheckedMove> shares = {test::checked(test::move_named("split, merge"))};
  require_right_together(fan(), Density(test::even_theta()), shares, 100);
}

TEST_CASE("Ratios hold for links among four and four", "[mcmc][ratios][heavy]") {
  require_right_together(two_rows(4), Density(test::even_theta()), all_but(kAllButLinks), 350);
}

TEST_CASE("Ratios hold on rings", "[mcmc][ratios][heavy]") {
  require_right_together(rings(), Density(test::even_theta()), all_but(kAllButLinks), 350);
}

TEST_CASE("Ratios hold for strokes that inherit from one of two", "[mcmc][ratios][heavy]") {
  require_right_together(heirs(), Density(test::even_theta()), all_but(kAllButLinks), 350);
}

TEST_CASE("Ratios hold where some merges cannot be", "[mcmc][ratios][heavy]") {
  require_right_together(apart(), Density(test::even_theta()), all_but(kAllButLinks), 100);
}

TEST_CASE("Each move alone has the right ratios from wherever it starts", "[mcmc][ratios][heavy]") {
  const Density density(test::even_theta());
  for (const auto& move : mcmc::moves()) {
    INFO(move.name);
    std::size_t transitions = 0;
    for (std::uint32_t number = 0; number < 6; ++number) {
      const bool patches = number % 2 == 0;
      const auto start = patches ? stirred(three_frames(), density, all_but(), number, 300)
                                 : stirred(heirs(), density, all_but(kPatchMoves), number, 300);
      const auto r = check_ratios(start, density, {test::checked(move)}, 20000);
      CHECK(r.complete);
      CHECK(r.worst_ratio <= 1e-10);
      CHECK(r.worst_balance <= 1e-14);
      CHECK(r.restored);
      transitions += r.transitions;
    }
    // Moves that a single start seldom allows are counted below.
    if (move.name != "hand over" && move.name != "shift a run") CHECK(transitions > 0);
  }
}

TEST_CASE("The models put every move to use", "[mcmc][ratios]") {
  const Density density(test::even_theta());
  std::map<std::string_view, Use> uses;
  std::vector<CheckedMove> counting;
  for (const auto& move : mcmc::moves()) {
    if (std::ranges::find(kAllButLinks, move.name) != kAllButLinks.end()) continue;
    Use& use = uses[move.name];
    counting.push_back(
        [&use, inner = test::checked(move)](mcmc::StateChange& change, mcmc::ChoiceSource& draws, int frame) {
          const HiddenGraph was = change.state();
          const auto ratio = inner(change, draws, frame);
          if (ratio && !(was == change.state())) {
            ++use.times;
            use.most_links = std::max(use.most_links, links_changed(was, change.state()));
          }
          return ratio;
        });
  }
  check_ratios(heirs(), density, counting);
  for (const auto& [name, use] : uses) {
    INFO(name);
    CHECK(use.times > 0);
  }
  CHECK(uses["shift a run"].most_links >= 2);
  CHECK(uses["hand over"].most_links == 3);
  CHECK(uses["tie strokes"].most_links == 3);
  check_ratios(two_rows(4), density, counting);
  CHECK(uses["shift a run"].most_links == 3);
  CHECK(uses["tie strokes"].most_links == 4);
}
