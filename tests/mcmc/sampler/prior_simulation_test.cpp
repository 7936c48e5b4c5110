// SPDX-License-Identifier: Apache-2.0
// The density is normalised, and moves keep its law: both against draws from it.
#include "mcmc/sampler/prior_simulation.hpp"

#include <cmath>
#include <functional>
#include <map>
#include <string>

#include "core/error.hpp"
#include "tests/mcmc/sampler/free_chain.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

struct Change {
  const char* name;
  std::function<void(SamplerParameters&)> apply;
};
const std::vector<Change>& changes() {
  static const std::vector<Change> all = {
      {"birth in frame 0", [](SamplerParameters& t) { t.birth[0] *= 1.15; }},
      {"birth", [](SamplerParameters& t) { t.birth[1] *= 1.15; }},
      {"growth of ends", [](SamplerParameters& t) { t.growth[0] *= 1.3; }},
      {"growth inside", [](SamplerParameters& t) { t.growth[1] *= 1.4; }},
      {"growth of junctions", [](SamplerParameters& t) { t.growth[2] *= 1.4; }},
      {"growth of what is new", [](SamplerParameters& t) { t.growth[3] *= 1.2; }},
      {"growth in frame 0", [](SamplerParameters& t) { t.first_growth *= 1.15; }},
      {"death",
       [](SamplerParameters& t) {
         for (auto& c : t.outcome) c[0] += 0.03, c[1] -= 0.03;
       }},
      {"death where neighbours died",
       [](SamplerParameters& t) {
         for (std::size_t c = 2; c < mcmc::kOutcomeContexts; c += 3)
           t.outcome[c][0] += 0.1, t.outcome[c][1] -= 0.1;
       }},
      {"splits",
       [](SamplerParameters& t) {
         for (auto& c : t.outcome) c[2] += 0.03, c[1] -= 0.03;
       }},
      {"merges",
       [](SamplerParameters& t) {
         for (auto& c : t.outcome) c[3] += 0.03, c[1] -= 0.03;
       }},
      {"further parts", [](SamplerParameters& t) { t.split_more += 0.05; }},
      {"keep",
       [](SamplerParameters& t) {
         for (double& p : t.join[2]) p -= 0.02;
       }},
      {"connect",
       [](SamplerParameters& t) {
         for (double& p : t.join[0]) p += 0.03;
       }},
      {"close in frame 0",
       [](SamplerParameters& t) {
         for (double& p : t.close[0]) p += 0.05;
       }},
      {"close",
       [](SamplerParameters& t) {
         for (double& p : t.close[1]) p += 0.06;
       }},
      {"along", [](SamplerParameters& t) { t.along *= 1.05; }},
      {"across", [](SamplerParameters& t) { t.across *= 1.05; }},
      {"turn", [](SamplerParameters& t) { t.turn *= 1.06; }},
      {"flicker", [](SamplerParameters& t) { t.flicker *= 1.06; }},
      {"spread of parts", [](SamplerParameters& t) { t.split_spread *= 1.06; }},
      {"a1", [](SamplerParameters& t) { t.displacement.a1 += 0.03; }},
      {"a2", [](SamplerParameters& t) { t.displacement.a2 += 0.03; }},
      {"noise", [](SamplerParameters& t) { t.displacement.noise *= 1.03; }},
      {"coupling", [](SamplerParameters& t) { t.displacement.coupling += 0.05; }},
      {"step", [](SamplerParameters& t) { t.step += 0.1; }},
      {"spread of steps", [](SamplerParameters& t) { t.step_sd *= 1.1, t.side_sd *= 1.1, t.bend_sd *= 1.1; }},
      {"branches", [](SamplerParameters& t) { t.branch += 0.05; }},
      {"contrast", [](SamplerParameters& t) { t.new_contrast += 0.02, t.grown_contrast_sd *= 1.1; }},
      {"kinds",
       [](SamplerParameters& t) {
         t.kinds = {0.45, 0.3, 0.25};
       }},
      {"other kinds", [](SamplerParameters& t) { t.other_kind = 0.08; }}};
  return all;
}

bool crowded(const HiddenGraph& g) {
  for (Index i = 0; i < g.size(); ++i)
    if (g[i].edges.full() || g[i].next.full() || g[i].prev.full()) return true;
  return false;
}

/// E[π′(x)/π(x)] = 1 over draws x from π, whatever π′: where a factor were not normalised, or the draws not
/// from it, it would not be.
void check_normalised(std::uint32_t draws) {
  const SamplerParameters theta = test::lively_theta();
  const Density density(theta);
  std::vector<Density> changed;
  for (const Change& change : changes()) {
    SamplerParameters t = theta;
    change.apply(t);
    changed.emplace_back(t);
  }
  std::vector<std::vector<double>> ratios(changed.size());
  std::map<mcmc::Outcome, int> seen;
  for (std::uint32_t n = 0; n < draws; ++n) {
    core::Rng rng(7, {n, 0, 0});
    const auto g = simulate_prior(theta, 50, 50, 3, test::kLivelyGates, rng);
    const double log_density = density.total(g);
    // In a hundred thousand draws one is so crowded that an edge finds no room any more.
    if (!std::isfinite(log_density)) REQUIRE(crowded(g));
    for (std::size_t k = 0; k < changed.size(); ++k)
      ratios[k].push_back(std::isfinite(log_density) ? std::exp(changed[k].total(g) - log_density) : 1);
    for (const int t : {0, 1})
      for (const Index i : g.active(t)) ++seen[mcmc::outcome(g, i)];
  }
  for (const auto what :
       {mcmc::Outcome::death, mcmc::Outcome::survival, mcmc::Outcome::split, mcmc::Outcome::merge})
    CHECK(seen[what] > 50);
  for (std::size_t k = 0; k < changed.size(); ++k) {
    const test::Mean mean = test::mean_of(ratios[k]);
    INFO(changes()[k].name << ": " << mean.value << " +- " << mean.error);
    CHECK(mean.error > 0);
    CHECK(std::abs(test::z_score(mean, {1, 0})) < 4.5);
  }
}

constexpr int kSize = 30, kFrames = 3;
constexpr mcmc::Gates kFreeGates{14, 16, 0};
SamplerParameters small_theta() {
  SamplerParameters t = test::lively_theta();
  t.birth = {0.002, 0.0006};
  t.growth = {0.12, 0.06, 0.1, 0.6};
  t.first_growth = 0.7;
  // Spread wide, so that a chain finds its way.
  t.along = 2, t.across = 1.5, t.turn = 0.4, t.flicker = 0.3;
  t.step_sd = 1, t.side_sd = 1.2, t.bend_sd = 0.4, t.grown_contrast_sd = 0.3;
  t.displacement.noise = 0.5;
  for (std::size_t k = 0; k < mcmc::kCloseness; ++k) t.join[1][k] = t.join[0][k] + 0.02;
  return t;
}
HiddenGraph forward(const SamplerParameters& theta, std::uint32_t purpose, std::uint32_t number) {
  core::Rng rng(31, {purpose, number, 0});
  return simulate_prior(theta, kSize, kSize, kFrames, kFreeGates, rng);
}

/// Compares chains of `moves` moves in all, each begun at a draw of its own, with `draws` draws. Their means
/// are independent, so the test holds however slowly a chain mixes.
void check_prior(int moves, std::uint32_t draws) {
  constexpr std::uint32_t kChains = 200;
  const SamplerParameters theta = small_theta();
  std::vector<std::vector<double>> drawn, chained;
  std::vector<std::string> names;
  const auto values = [&](const HiddenGraph& g) {
    std::vector<double> result;
    names.clear();
    for (const auto& one : test::statistics(g)) result.push_back(one.value), names.push_back(one.name);
    return result;
  };
  const auto note = [](const std::vector<double>& of, auto& into) {
    into.resize(of.size());
    for (std::size_t k = 0; k < of.size(); ++k) into[k].push_back(of[k]);
  };
  for (std::uint32_t n = 0; n < draws; ++n) note(values(forward(theta, 0, n)), drawn);
  double accepted = 0;
  for (std::uint32_t c = 0; c < kChains; ++c) {
    test::FreeChain chain(forward(theta, 1, c), theta, kFreeGates, core::Rng(32, {c, 0, 0}));
    const int own = moves / static_cast<int>(kChains);
    std::vector<double> mean(drawn.size(), 0);
    for (int n = 0; n < own; ++n) {
      chain.step(true);
      if (n % 10 != 9) continue;
      const auto now = values(chain.state());
      for (std::size_t k = 0; k < mean.size(); ++k) mean[k] += now[k] * 10 / own;
    }
    note(mean, chained);
    accepted += static_cast<double>(chain.accepted());
  }
  CHECK(accepted > 0.05 * moves);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const test::Mean a = test::mean_of(drawn[k]), b = test::mean_of(chained[k]);
    INFO(names[k] << ": " << a.value << " +- " << a.error << " drawn, " << b.value << " +- " << b.error
                  << " in the chains, z = " << test::z_score(a, b));
    CHECK(std::abs(test::z_score(a, b)) < 5);
  }
}

/// States drawn from the density, each moved by one kind of move alone: their law stays.
void check_kept(const char* name, const std::function<void(test::FreeChain&)>& step, std::uint32_t draws,
                bool seldom = false, int steps = 30) {
  const SamplerParameters theta = small_theta();
  std::vector<std::vector<double>> change;
  std::vector<std::string> names;
  std::size_t accepted = 0;
  for (std::uint32_t n = 0; n < draws; ++n) {
    test::FreeChain chain(forward(theta, 2, n), theta, kFreeGates, core::Rng(33, {n, 0, 0}));
    auto was = test::statistics(chain.state());
    const double log_density = chain.density().total(chain.state());
    for (int k = 0; k < steps; ++k) step(chain);
    auto is = test::statistics(chain.state());
    was.push_back({"log density", log_density});
    is.push_back({"log density", chain.density().total(chain.state())});
    change.resize(is.size()), names.resize(is.size());
    for (std::size_t k = 0; k < is.size(); ++k) {
      change[k].push_back(is[k].value - was[k].value);
      names[k] = is[k].name;
    }
    accepted += chain.accepted();
  }
  INFO(name << ", " << accepted << " accepted");
  if (!seldom) CHECK(accepted > 20);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const test::Mean mean = test::mean_of(change[k]);
    INFO(names[k] << " changes by " << mean.value << " +- " << mean.error);
    if (mean.error > 0) CHECK(std::abs(test::z_score(mean, {0, 0})) < 4.5);
  }
}
void check_each_kept(std::uint32_t draws) {
  for (const auto& move : mcmc::moves()) {
    if (move.over_time) continue;  // tracks are of candidates, which there are none of here
    check_kept(
        move.name.data(), [&](test::FreeChain& chain) { chain.step(move); }, draws,
        move.propose == mcmc::relink_stroke);
  }
  check_kept(
      "sway", [](test::FreeChain& chain) { chain.move_displacement(); }, draws);
}

}  // namespace

TEST_CASE("The density is normalised and drawn from", "[mcmc][forward]") {
  check_normalised(4000);
}
TEST_CASE("Closely: the density is normalised and drawn from", "[mcmc][forward][slow]") {
  check_normalised(120000);
}

TEST_CASE("Each move alone keeps the law of what is drawn", "[mcmc][forward][heavy]") {
  check_each_kept(2000);
}
TEST_CASE("Closely: each move alone keeps the law of what is drawn", "[mcmc][forward][slow]") {
  check_each_kept(8000);
}

TEST_CASE("Moves of all kinds keep the law of what is drawn", "[mcmc][forward][heavy]") {
  check_kept(
      "all", [](test::FreeChain& chain) { chain.step(true); }, 1000, false, 500);
}
TEST_CASE("Closely: moves of all kinds keep the law of what is drawn", "[mcmc][forward][slow]") {
  check_kept(
      "all", [](test::FreeChain& chain) { chain.step(true); }, 10000, false, 1000);
}

TEST_CASE("Chains of a million moves without images have the law of what is drawn", "[mcmc][forward][slow]") {
  check_prior(1000000, 100000);
}

TEST_CASE("Forward draws are what the seed says and all of it is on", "[mcmc][forward]") {
  const auto a = forward(small_theta(), 5, 1), b = forward(small_theta(), 5, 1),
             c = forward(small_theta(), 5, 2);
  CHECK(a == b);
  CHECK(a.hash() == b.hash());
  CHECK(a.hash() != c.hash());
  for (int t = 0; t < kFrames; ++t) CHECK(a.inactive(t).empty());
  core::Rng rng(1, {0, 0, 0});
  REQUIRE_THROWS_AS(simulate_prior(small_theta(), 30, 30, 0, kFreeGates, rng), core::InputError);
  SamplerParameters wrong = small_theta();
  wrong.birth[0] = -1;
  REQUIRE_THROWS_AS(simulate_prior(wrong, 30, 30, 2, kFreeGates, rng), core::InputError);
}
