// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/state_change.hpp"

#include <cmath>
#include <limits>

#include "tests/mcmc/sampler/small_models.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

/// One step at random; false where none was found.
bool step(StateChange& change, core::Rng& rng, int& kind) {
  const HiddenGraph& g = change.state();
  const Index i = rng.below(static_cast<std::uint32_t>(g.size()));
  const auto& node = g[i];
  kind = static_cast<int>(rng.below(7));
  switch (kind) {
    case 0:
      if (g.can_activate(i)) return change.activate(i), true;
      return false;
    case 1:
      if (!node.active || !node.edges.empty() || !node.next.empty() || !node.prev.empty()) return false;
      return change.deactivate(i), true;
    case 2:
      for (const auto& near : g.neighbours(i))
        if (rng.below(2) == 0 && g.can_add_edge(i, near.node)) return change.add_edge(i, near.node), true;
      return false;
    case 3:
      if (node.edges.empty()) return false;
      return change.remove_edge(i, node.edges[rng.below(static_cast<std::uint32_t>(node.edges.size()))]),
             true;
    case 4:
      for (const Index to : g.candidates_after(i))
        if (rng.below(2) == 0 && g.can_link(i, to)) return change.link(i, to), true;
      return false;
    case 5:
      if (node.next.empty()) return false;
      return change.unlink(i, node.next[rng.below(static_cast<std::uint32_t>(node.next.size()))]), true;
    default:
      if (!node.active) return false;
      return change.set_displacement(i, node.displacement + rng.normal()), true;
  }
}

double relative(double difference, double total) {
  return std::abs(difference) / (1 + std::abs(total));
}

}  // namespace

TEST_CASE("Each step gains what the whole density gains", "[mcmc][edit]") {
  std::array<int, 7> seen{};
  int impossible = 0;
  for (std::uint32_t number = 0; number < 60; ++number) {
    const bool borders = number % 2 == 1;
    const Density density(borders ? test::even_theta() : test::lively_theta());
    HiddenGraph g = test::drawn_state(number, 4, borders ? 25 : 50, 20, number % 3 == 0 ? 2 : 0);
    core::Rng rng(21, {number, 0, 0});
    mcmc::FactorCache cache;
    cache.resize(g.size());
    StateChange change(g, density, cache);
    double before = density.total(g);
    REQUIRE(std::isfinite(before));
    for (int n = 0; n < 400; ++n) {
      int kind = 0;
      if (!step(change, rng, kind)) continue;
      const double after = density.total(g);
      if (!std::isfinite(after)) {
        CHECK(change.gain() == -std::numeric_limits<double>::infinity());
        change.rollback();
        ++impossible;
        continue;
      }
      INFO("state " << number << ", step " << n << " of kind " << kind);
      REQUIRE(relative(change.gain() - (after - before), after) <= 1e-9);
      change.commit();
      before = after;
      ++seen[static_cast<std::size_t>(kind)];
    }
  }
  for (const int times : seen) CHECK(times > 100);
  CHECK(impossible > 0);
}

TEST_CASE("Steps add up and undone leave no trace", "[mcmc][edit]") {
  const Density density(test::lively_theta());
  int whole = 0;
  for (std::uint32_t number = 0; number < 30; ++number) {
    HiddenGraph g = test::drawn_state(100 + number, 4, 50, 20);
    core::Rng rng(22, {number, 0, 0});
    mcmc::FactorCache cache;
    cache.resize(g.size());
    StateChange change(g, density, cache);
    for (int round = 0; round < 20; ++round) {
      const HiddenGraph was = g;
      const auto hash = g.hash();
      const double before = density.total(g);
      CHECK(change.empty());
      for (int n = 0, kind = 0; n < 12; ++n) step(change, rng, kind);
      const double after = density.total(g);
      CHECK(std::isfinite(change.gain()) == std::isfinite(after));
      if (std::isfinite(after)) {
        REQUIRE(relative(change.gain() - (after - before), after) <= 1e-9);
        ++whole;
      }
      if (round % 2 == 1 && std::isfinite(after)) {
        change.commit();
        CHECK(change.gain() == 0);
        continue;
      }
      change.rollback();
      CHECK(change.empty());
      CHECK(change.gain() == 0);
      REQUIRE(g.hash() == hash);
      REQUIRE(g == was);
      REQUIRE(density.total(g) == before);
    }
  }
  CHECK(whole > 200);
}

TEST_CASE("Two edits of one state far apart in time share their marks", "[mcmc][edit]") {
  const Density density(test::lively_theta());
  HiddenGraph g = test::drawn_state(3, 9, 50, 40), alone = g;
  mcmc::FactorCache cache, own;
  cache.resize(g.size()), own.resize(g.size());
  StateChange early(g, density, cache, 0), late(g, density, cache, 1);
  StateChange judge(alone, density, own, 0);
  core::Rng rng(23, {0, 0, 0});
  int pairs = 0;
  for (int n = 0; n < 2000; ++n) {
    const Index i = rng.below(static_cast<std::uint32_t>(g.size()));
    if (!g[i].active || (g[i].frame != 1 && g[i].frame != 8)) continue;
    const double displacement = rng.normal();
    StateChange& change = g[i].frame == 1 ? early : late;
    const double had = change.gain();
    change.set_displacement(i, displacement);
    judge.set_displacement(i, displacement);
    CHECK_THAT(change.gain() - had, Catch::Matchers::WithinAbs(judge.gain(), 1e-9));
    judge.commit();
    ++pairs;
  }
  CHECK(pairs > 20);
  CHECK(g == alone);
}

TEST_CASE("After ten thousand moves gains add up to the density", "[mcmc][edit]") {
  const Density density(test::lively_theta());
  HiddenGraph g = test::drawn_state(7, 5, 50, 40, 1.5);
  mcmc::FactorCache cache;
  cache.resize(g.size());
  StateChange change(g, density, cache);
  mcmc::RandomChoices draws(core::Rng(24, {0, 0, 0}));
  core::Rng rng(25, {0, 0, 0});
  double sum = density.total(g);
  int accepted = 0, rejected = 0;
  for (int n = 0; n < 10000; ++n) {
    const auto& move = mcmc::moves()[rng.below(static_cast<std::uint32_t>(mcmc::moves().size()))];
    const int frame = static_cast<int>(rng.below(move.between_frames ? 4 : 5));
    const auto hash = g.hash();
    const auto ratio = move.propose(change, draws, frame);
    if (!ratio) {
      INFO(move.name);
      REQUIRE(change.empty());
      REQUIRE(g.hash() == hash);
      continue;
    }
    if (std::log1p(-rng.uniform()) < change.gain() + *ratio) {
      sum += change.gain();
      change.commit();
      ++accepted;
    } else {
      change.rollback();
      ++rejected;
      REQUIRE(g.hash() == hash);
    }
    if (n % 1000 == 999) REQUIRE(relative(sum - density.total(g), sum) <= 1e-9);
  }
  CHECK(accepted > 300);
  CHECK(rejected > 1000);
}

TEST_CASE("A gain that is asked for from a level on is the gain or lies below it", "[mcmc][edit]") {
  int hidden = 0, visible = 0;
  for (std::uint32_t number = 0; number < 12; ++number) {
    auto theta = number % 2 == 0 ? test::lively_theta() : test::even_theta();
    theta.displacement.coupling = number % 3 == 0 ? 0.1 : 0;
    Density density(theta);
    HiddenGraph g = test::drawn_state(200 + number, 5, 50, 30, 1.5);
    if (number < 6) density.prepare(g);
    mcmc::FactorCache cache;
    cache.enable(g);
    StateChange change(g, density, cache);
    mcmc::RandomChoices draws(core::Rng(26, {number, 0, 0}));
    core::Rng rng(27, {number, 0, 0});
    for (int n = 0; n < 1500; ++n) {
      const auto& move = mcmc::moves()[rng.below(static_cast<std::uint32_t>(mcmc::moves().size()))];
      const auto ratio =
          move.propose(change, draws, static_cast<int>(rng.below(move.between_frames ? 4 : 5)));
      if (!ratio) continue;
      const double gain = change.gain();
      INFO(move.name << ", gain " << gain);
      for (const double above : {-5.0, -1e-3, 1e-3, 3.0, 50.0}) {
        const double bounded = change.gain(gain + above);
        if (above < 0)
          REQUIRE(bounded == gain);
        else
          REQUIRE((bounded == gain || bounded == -std::numeric_limits<double>::infinity()));
        (bounded == gain ? visible : hidden) += 1;
      }
      const double before = density.total(g);
      if (std::log1p(-rng.uniform()) < gain + *ratio) {
        change.commit();
        continue;
      }
      change.rollback();
      // The cached factors are still valid.
      if (std::isfinite(gain)) REQUIRE(relative(gain - (before - density.total(g)), before) <= 1e-9);
    }
  }
  CHECK(hidden > visible / 4);
}
