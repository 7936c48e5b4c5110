// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/change_chain.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "core/rng.hpp"
#include "mcmc/sampler/change_moves.hpp"
#include "mcmc/sampler/life_costs.hpp"
#include "tests/mcmc/sampler/change_fields.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using graph::EventType;
using mcmc::ChangeField;
using mcmc::ChangeState;
using mcmc::detail::ChangeChain;
using mcmc::detail::kLifeCost;
using mcmc::detail::LifeCosts;

namespace {

std::vector<double> odds_of(const ChangeField& field) {
  std::vector<double> odds;
  for (const auto& change : field.changes) odds.push_back(change.log_odds);
  return odds;
}

ChangeState random_state(const ChangeField& field, core::Rng& rng) {
  ChangeState state{std::vector<bool>(field.changes.size()), std::vector<bool>(field.gaps.size())};
  for (std::size_t k = 0; k < field.changes.size(); ++k) state.happened[k] = rng.uniform() < 0.5;
  return state;
}

double cost(const ChangeField& field, std::vector<bool> happened, std::vector<bool> bridged = {}) {
  bridged.resize(field.gaps.size());
  const ChangeState state{std::move(happened), std::move(bridged)};
  return LifeCosts(field, std::vector<bool>(field.changes.size(), true), state).noted_of_all() / kLifeCost;
}

// A stroke that is there from the first frame on parts in frame 10; one part dies in 20, the other stays.
ChangeField part_that_dies() {
  return {{{0, 9, true, false, 50, 0}, {10, 19, false, false, 50, 0}, {10, 39, false, true, 150, 0}},
          {{EventType::split, 10, {}, 0, true, {0}, {1, 2}}, {EventType::death, 20, {}, 0, true, {1}, {}}},
          {}};
}

}  // namespace

TEST_CASE("A birth or death costs where it is none of a whole stroke", "[changes]") {
  const ChangeField field = part_that_dies();
  CHECK(cost(field, {false, false}) == 0);
  CHECK(cost(field, {true, true}) == 0);
  CHECK(cost(field, {true, false}) * kLifeCost ==
        mcmc::detail::kPartCost);          // the part ends, but does not die
  CHECK(cost(field, {false, true}) == 1);  // a part of a stroke dies
  // The same backwards: a stroke is born and joins one that was there before.
  const ChangeField joins = {
      {{10, 19, false, false, 50, 0}, {0, 19, true, false, 100, 0}, {20, 39, false, true, 100, 0}},
      {{EventType::birth, 10, {}, 0, true, {}, {0}}, {EventType::merge, 20, {}, 0, true, {0, 1}, {2}}},
      {}};
  CHECK(cost(joins, {true, true}) == 0);
  CHECK(cost(joins, {true, false}) == 1);
  // Of what begins by no change nothing is known.
  CHECK(cost({{{5, 14, false, false, 50, 0}}, {{EventType::death, 15, {}, 0, true, {0}, {}}}, {}}, {true}) ==
        0);
  // Both ends of a stroke, or none; what goes out, and the outline of a thing, need none.
  ChangeField life = {
      {{5, 14, false, false, 50, 0}},
      {{EventType::birth, 5, {}, 0, true, {}, {0}}, {EventType::death, 15, {}, 0, true, {0}, {}}},
      {}};
  CHECK(cost(life, {false, false}) == 0);
  CHECK(cost(life, {true, true}) == 0);
  CHECK(cost(life, {true, false}) == 1);
  CHECK(cost(life, {false, true}) == 1);
  life.strands[0].goes_out = true;
  CHECK(cost(life, {true, false}) == 0);
  CHECK(cost(life, {false, true}) == 1);
  life.strands[0] = {5, 14, false, false, 210, 10};
  CHECK(cost(life, {true, false}) == 0);
  life.strands[0].patches = 190;
  CHECK(cost(life, {true, false}) == 1);
  // A stroke that goes on through a gap is one.
  const ChangeField gap = {{{5, 14, false, false, 50, 0}, {17, 29, false, false, 50, 0}},
                           {{EventType::birth, 5, {}, 0, true, {}, {0}},
                            {EventType::death, 15, {}, 0, true, {0}, {}},
                            {EventType::birth, 17, {}, 0, true, {}, {1}},
                            {EventType::death, 30, {}, 0, true, {1}, {}}},
                           {{1, 2}}};
  CHECK(cost(gap, {true, false, false, true}) == 2);
  CHECK(cost(gap, {true, false, false, true}, {true}) == 0);
  CHECK(cost(gap, {true, true, true, true}) == 0);
  CHECK(cost(gap, {false, false, false, true}, {true}) == 1);
}

TEST_CASE("What a move costs is told by the lives that it touches", "[changes]") {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const ChangeField field = test::random_field(seed, 25);
    core::Rng rng(seed, {1});
    std::vector<bool> open;
    for (std::size_t k = 0; k < field.changes.size(); ++k)
      open.push_back(seed % 2 == 0 || rng.uniform() < 0.6);
    const std::vector<double> even(field.changes.size(), 0.0);
    ChangeState state = random_state(field, rng);
    for (std::size_t k = 0; k < open.size(); ++k)
      if (!open[k]) state.happened[k] = false;
    LifeCosts costs(field, open, state);
    for (const auto& move : mcmc::detail::change_moves(field, open)) {
      ChangeState next = state;
      for (const std::uint32_t k : move.changes) next.happened[k] = !next.happened[k];
      if (move.gap) next.bridged[*move.gap] = !next.bridged[*move.gap];
      const double after = mcmc::detail::log_density(field, even, next);
      if (!std::isfinite(after)) continue;
      const double change = mcmc::detail::log_density(field, even, state) - after;
      CHECK(costs.noted(move.strands) == costs.of(move.strands, state));
      CHECK(costs.of(move.strands, next) - costs.noted(move.strands) == Approx(change).margin(1e-9));
      if (rng.uniform() > 0.3) continue;
      state = std::move(next);
      costs.of(move.strands, state);
      costs.note();
      CHECK(costs.noted_of_all() == Approx(-after).margin(1e-9));
    }
  }
}

TEST_CASE("A chain has each state as often as its density says", "[changes]") {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const ChangeField field = test::random_field(seed, 7, 1);
    const auto odds = odds_of(field);
    const std::size_t n = field.changes.size(), m = field.gaps.size(), states = std::size_t{1} << (n + m);
    REQUIRE(n + m <= 14);
    const auto state_of = [&](std::size_t bits) {
      ChangeState state{std::vector<bool>(n), std::vector<bool>(m)};
      for (std::size_t k = 0; k < n; ++k) state.happened[k] = (bits >> k & 1) != 0;
      for (std::size_t g = 0; g < m; ++g) state.bridged[g] = (bits >> (n + g) & 1) != 0;
      return state;
    };
    std::vector<double> expected(states);
    double sum = 0;
    for (std::size_t bits = 0; bits < states; ++bits)
      sum += expected[bits] = std::exp(mcmc::detail::log_density(field, odds, state_of(bits)));
    constexpr int kSweeps = 40'000;
    std::vector<double> found(states);
    ChangeChain chain(field, state_of(0));
    chain.open(std::vector<bool>(n, true));
    const auto moves = mcmc::detail::change_moves(field, std::vector<bool>(n, true));
    for (std::uint32_t sweep = 0; sweep < kSweeps; ++sweep) {
      core::Rng rng(seed, {2, sweep});
      chain.sweep(moves, odds, rng);
      std::size_t bits = 0;
      for (std::size_t k = 0; k < n; ++k) bits |= std::size_t{chain.state().happened[k]} << k;
      for (std::size_t g = 0; g < m; ++g) bits |= std::size_t{chain.state().bridged[g]} << (n + g);
      found[bits] += 1.0 / kSweeps;
    }
    double apart = 0;  // total variation
    for (std::size_t bits = 0; bits < states; ++bits) {
      if (expected[bits] == 0) CHECK(found[bits] == 0);
      apart += 0.5 * std::abs(found[bits] - expected[bits] / sum);
    }
    INFO("seed " << seed << ", " << n << " changes, " << m << " gaps");
    CHECK(apart < 0.03 + 0.5 * std::sqrt(static_cast<double>(states) / kSweeps) / 2);
  }
}

TEST_CASE("Moves of a clip played backwards are the same", "[changes]") {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const ChangeField field = test::random_field(seed, 20);
    const std::vector<bool> open(field.changes.size(), true);
    const auto listed = [&](const ChangeField& one) {
      std::multiset<std::pair<std::vector<std::uint32_t>, int>> moves;
      for (const auto& move : mcmc::detail::change_moves(one, open))
        moves.insert({move.changes, move.gap ? static_cast<int>(*move.gap) : -1});
      return moves;
    };
    CHECK(listed(field) == listed(test::reversed(field, 21)));
  }
}

TEST_CASE("Changes that are not open never happen", "[changes]") {
  const ChangeField field = test::random_field(3, 20);
  core::Rng rng(4);
  ChangeChain chain(field, random_state(field, rng));
  std::vector<bool> open(field.changes.size());
  for (std::size_t k = 0; k < open.size(); k += 2) open[k] = true;
  chain.open(open);
  const auto moves = mcmc::detail::change_moves(field, open);
  const std::vector<double> odds(field.changes.size(), 3.0);
  for (int sweep = 0; sweep < 20; ++sweep) {
    chain.sweep(moves, odds, rng);
    for (std::size_t k = 1; k < open.size(); k += 2) CHECK_FALSE(chain.state().happened[k]);
  }
  double tried = 0, accepted = 0;
  for (std::size_t kind = 0; kind < mcmc::detail::kMoveNames.size(); ++kind) {
    CHECK(chain.accepted().at(kind) <= chain.tried().at(kind));
    tried += chain.tried().at(kind), accepted += chain.accepted().at(kind);
  }
  CHECK(tried == 20.0 * static_cast<double>(moves.size()));
  CHECK(accepted > 0);
}
