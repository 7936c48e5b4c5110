// SPDX-License-Identifier: Apache-2.0
// Moves forwards and backwards between states of displaced patches at arbitrary places.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "tests/mcmc/sampler/small_models.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;
using mcmc::Move;

namespace {

struct Ways {
  double chance = 0;            ///< density of all draws that lead there
  std::vector<double> claimed;  ///< ratios, of each
};

/// All draws of the move that lead from one state to the other, normal draws being `displacements`.
Ways ways(HiddenGraph g, const Density& density, const Move& move, int frame,
          const std::vector<double>& displacements, const HiddenGraph& to) {
  mcmc::FactorCache cache;
  cache.resize(g.size());
  StateChange change(g, density, cache);
  AllDraws draws(displacements);
  Ways result;
  const auto goal = to.hash();
  do {
    const auto ratio = move.propose(change, draws, frame);
    if (ratio && g.hash() == goal && g == to) {
      result.chance += draws.chance();
      result.claimed.push_back(*ratio);
    }
    change.rollback();
  } while (draws.advance());
  return result;
}

/// The displacements of the patches that one of the states has and the other has not, by frame.
std::vector<double> added_displacements(const HiddenGraph& a, const HiddenGraph& b) {
  std::vector<std::pair<int, double>> added;
  for (Index i = 0; i < a.size(); ++i)
    if (a[i].active != b[i].active)
      added.emplace_back(a[i].frame, a[i].active ? a[i].displacement : b[i].displacement);
  std::ranges::stable_sort(added, {}, &std::pair<int, double>::first);
  std::vector<double> displacements;
  for (const auto& one : added) displacements.push_back(one.second);
  return displacements;
}

/// Makes moves at random, each tried back and forth.
void there_and_back(HiddenGraph g, std::uint32_t number, int times, bool strokes,
                    std::map<std::string_view, int>& seen) {
  const Density density(test::lively_theta());
  core::Rng rng(17, {number, 0, 0});
  mcmc::FactorCache cache;
  cache.resize(g.size());
  StateChange change(g, density, cache);
  mcmc::RandomChoices draws(rng);
  for (int n = 0; n < times; ++n) {
    // Strokes are left whole, and are tied more often than elsewhere: there must be some to hand over.
    const auto all = strokes ? mcmc::moves().last(3) : mcmc::moves();
    const Move& move = all[draws.below(all.size())];
    const int frame =
        static_cast<int>(draws.below(static_cast<std::size_t>(g.frames() - move.between_frames)));
    const HiddenGraph was = g;
    const auto ratio = move.propose(change, draws, frame);
    if (!ratio || !std::isfinite(change.gain()) || was == g) {
      change.rollback();
      continue;
    }
    change.commit();
    const auto displacements = added_displacements(was, g);
    const Ways there = ways(was, density, move, frame, displacements, g);
    const Ways back = ways(g, density, move, frame, displacements, was);
    INFO(move.name << " in state " << number << " after " << n);
    REQUIRE(!there.claimed.empty());
    REQUIRE(!back.claimed.empty());
    double worst = std::abs(std::log(back.chance) - std::log(there.chance) - *ratio);
    for (const double claimed : there.claimed) worst = std::max(worst, std::abs(claimed - *ratio));
    for (const double claimed : back.claimed) worst = std::max(worst, std::abs(claimed + *ratio));
    REQUIRE(worst <= 1e-12 * (1 + std::abs(*ratio)));
    ++seen[move.name];
  }
}

/// Two strokes before, one after between them, all of them swaying.
HiddenGraph heirs(std::uint32_t number) {
  core::Rng rng(18, {number, 0, 0});
  HiddenGraph g(60, 60, 2, {6, 12, 0});
  test::row(g, 0, 3, 20, 20), test::row(g, 0, 3, 20, 27), test::row(g, 1, 3, 20, 23);
  for (Index i = 0; i < g.size(); ++i) g.set_displacement(i, rng.normal());
  test::furnish(g);
  return g;
}

}  // namespace

TEST_CASE("What a move claims on random states is what the way back denies", "[mcmc][ratios]") {
  std::map<std::string_view, int> seen;
  for (std::uint32_t number = 0; number < 12; ++number)
    there_and_back(test::drawn_state(number, 3, 50, 5), number, 60, false, seen);
  for (std::uint32_t number = 0; number < 40; ++number) there_and_back(heirs(number), number, 40, true, seen);
  for (const Move& move : mcmc::moves()) {
    INFO(move.name << ": " << seen[move.name]);
    CHECK(seen[move.name] >= 4);
  }
}
