// SPDX-License-Identifier: Apache-2.0
// States and rates together: moves of states and draws of rates by turns have the law that both are drawn
// from (Geweke 2004), and ranks among posterior draws are uniform (Talts et al. 2018).
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/mcmc/sampler/free_chain.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/statistics.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

constexpr int kJointSize = 30, kJointFrames = 3;
constexpr mcmc::Gates kGates{14, 16, 0};

double gamma(core::Rng& rng, double shape) {
  if (shape < 1) return gamma(rng, shape + 1) * std::pow(1 - rng.uniform(), 1 / shape);
  // Marsaglia & Tsang 2000.
  const double d = shape - 1.0 / 3, c = 1 / std::sqrt(9 * d);
  for (;;) {
    const double x = rng.normal(), v = std::pow(1 + c * x, 3);
    if (v > 0 && std::log(1 - rng.uniform()) < 0.5 * x * x + d - d * v + d * std::log(v)) return d * v;
  }
}

/// Counts of successes and failures on top of the prior's.
struct Beta {
  double yes = 0, no = 0;
  double draw(core::Rng& rng) const {
    const double a = gamma(rng, yes), b = gamma(rng, no);
    return std::clamp(a / (a + b), 1e-12, 1 - 1e-12);
  }
  [[nodiscard]] double log_density(double p) const {
    return (yes - 1) * std::log(p) + (no - 1) * std::log(1 - p);
  }
};
struct Rate {
  double count = 0, exposure = 0;
  double draw(core::Rng& rng) const { return gamma(rng, count) / exposure; }
  [[nodiscard]] double log_density(double r) const { return (count - 1) * std::log(r) - exposure * r; }
};
using Shares = std::array<double, 3>;
Shares dirichlet(core::Rng& rng, const Shares& counts) {
  Shares result{};
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) sum += result[k] = std::max(gamma(rng, counts[k]), 1e-12);
  for (double& p : result) p /= sum;
  return result;
}

/// The law of all rates: conjugate priors, or posteriors given a state and where its patches grew from. What
/// becomes of a patch is drawn as whether it merges, if it can, and what else it does if not.
struct Rates {
  std::array<Rate, 2> birth;
  std::array<Rate, mcmc::kParentClasses> growth;
  Rate first_growth;
  std::array<Beta, mcmc::kOutcomeContexts> merge;
  std::array<Shares, mcmc::kOutcomeContexts> otherwise{};
  Beta split_more{2, 18}, other_kind{2, 30};
  Shares kinds{10, 6, 4};
  std::array<std::array<Beta, mcmc::kCloseness>, 3> join;  ///< [were]
  std::array<std::array<Beta, mcmc::kCloseness>, 2> close;

  Rates() {
    const auto about = [](double mean) { return Rate{30, 30 / mean}; };
    birth = {about(0.002), about(0.0006)};
    growth = {about(0.12), about(0.06), about(0.1), about(0.6)};
    first_growth = about(0.7);
    merge.fill({3, 30});
    otherwise.fill({6, 24, 3});
    join[0].fill({2, 12}), join[1].fill({3, 9}), join[2].fill({8, 2});
    close[0].fill({2, 14}), close[1].fill({2, 12});
  }

  SamplerParameters draw(core::Rng& rng) const {
    SamplerParameters t = test::lively_theta();
    t.along = 2, t.across = 1.5, t.turn = 0.4, t.flicker = 0.3;
    t.step_sd = 1, t.side_sd = 1.2, t.bend_sd = 0.4, t.grown_contrast_sd = 0.3;
    for (std::size_t e = 0; e < 2; ++e) t.birth[e] = birth[e].draw(rng);
    for (std::size_t k = 0; k < mcmc::kParentClasses; ++k) t.growth[k] = growth[k].draw(rng);
    t.first_growth = first_growth.draw(rng);
    for (std::size_t c = 0; c < mcmc::kOutcomeContexts; ++c) {
      const double m = merge[c].draw(rng);
      const Shares rest = dirichlet(rng, otherwise[c]);
      t.outcome[c] = {(1 - m) * rest[0], (1 - m) * rest[1], (1 - m) * rest[2], m};
    }
    t.split_more = split_more.draw(rng), t.other_kind = other_kind.draw(rng);
    t.kinds = dirichlet(rng, kinds);
    for (std::size_t k = 0; k < mcmc::kCloseness; ++k) {
      for (std::size_t w = 0; w < 3; ++w) t.join[w][k] = join[w][k].draw(rng);
      for (std::size_t e = 0; e < 2; ++e) t.close[e][k] = close[e][k].draw(rng);
    }
    return t;
  }

  /// Up to a constant, in the rates as they are drawn.
  [[nodiscard]] double log_density(const SamplerParameters& t) const {
    double sum = first_growth.log_density(t.first_growth) + split_more.log_density(t.split_more) +
                 other_kind.log_density(t.other_kind);
    for (std::size_t e = 0; e < 2; ++e) sum += birth[e].log_density(t.birth[e]);
    for (std::size_t k = 0; k < mcmc::kParentClasses; ++k) sum += growth[k].log_density(t.growth[k]);
    for (std::size_t k = 0; k < 3; ++k) sum += (kinds[k] - 1) * std::log(t.kinds[k]);
    for (std::size_t c = 0; c < mcmc::kOutcomeContexts; ++c) {
      sum += merge[c].log_density(t.outcome[c][3]);
      for (std::size_t k = 0; k < 3; ++k)
        sum += (otherwise[c][k] - 1) * std::log(t.outcome[c][k] / (1 - t.outcome[c][3]));
    }
    for (std::size_t k = 0; k < mcmc::kCloseness; ++k) {
      for (std::size_t w = 0; w < 3; ++w) sum += join[w][k].log_density(t.join[w][k]);
      for (std::size_t e = 0; e < 2; ++e) sum += close[e][k].log_density(t.close[e][k]);
    }
    return sum;
  }

  /// Updates the posterior of the rates with a state. The origin of each new patch is drawn.
  void learn(const HiddenGraph& g, const Density& density, core::Rng& rng) {
    const double area = double(g.width()) * g.height();
    for (int t = 0; t < g.frames(); ++t) {
      birth[t == 0 ? 0 : 1].exposure += area;
      for (const Index i : g.active(t)) {
        g[i].prev.empty() ? learn_new(g, i, density, rng) : learn_survivor(g, i);
        if (t + 1 < g.frames()) learn_outcome(g, i);
      }
    }
  }

 private:
  Rate& growing(const HiddenGraph& g, int frame, Index from) {
    return frame == 0 ? first_growth : growth[mcmc::parent_class(g, from)];
  }
  void learn_new(const HiddenGraph& g, Index w, const Density& density, core::Rng& rng) {
    const auto& node = g[w];
    growing(g, node.frame, w).exposure += 0.5;
    const auto origins = density.origins(g, w);
    Index from = mcmc::kNone;
    double left = rng.uniform() - origins.begun;
    for (std::size_t k = 0; k < origins.from.size() && left >= 0; ++k)
      left -= origins.shares[k], from = origins.from[k];
    if (from == mcmc::kNone) {
      birth[node.frame == 0 ? 0 : 1].count += 1;
      kinds[static_cast<std::size_t>(node.kind)] += 1;
    } else {
      growing(g, node.frame, from).count += 1;
      (g[from].kind == node.kind ? other_kind.no : other_kind.yes) += 1;
    }
    for (const auto& near : g.neighbours(w)) {
      const auto& other = g[near.node];
      if (!other.active || near.node == from || (other.prev.empty() && !g.precedes(near.node, w))) continue;
      Beta& closes = close[node.frame == 0 ? 0 : 1][near.closeness];
      (node.edges.has(near.node) ? closes.yes : closes.no) += 1;
    }
  }
  void learn_survivor(const HiddenGraph& g, Index w) {
    growth[mcmc::parent_class(g, w)].exposure += 1;
    for (const auto& near : g.neighbours(w)) {
      if (near.node < w || !g[near.node].active || g[near.node].prev.empty()) continue;
      Beta& chance =
          join[static_cast<std::size_t>(mcmc::previous_adjacency(g, w, near.node))][near.closeness];
      (g[w].edges.has(near.node) ? chance.yes : chance.no) += 1;
    }
  }
  void learn_outcome(const HiddenGraph& g, Index v) {
    const auto what = outcome(g, v);
    const std::size_t c = mcmc::outcome_context_of(g, v);
    if (mcmc::merge_targets(g, v) > 0) (what == mcmc::Outcome::merge ? merge[c].yes : merge[c].no) += 1;
    if (what != mcmc::Outcome::merge) otherwise[c][static_cast<std::size_t>(what)] += 1;
    if (what == mcmc::Outcome::split) {
      split_more.yes += static_cast<double>(g[v].next.size()) - 2;
      split_more.no += 1;
    }
  }
};

/// Rates given the state, the ones before being `density`'s. Reversible.
SamplerParameters draw_rates(const HiddenGraph& g, const Density& density, core::Rng& rng) {
  Rates rates;
  rates.learn(g, density, rng);
  SamplerParameters drawn = rates.draw(rng);
  // Numbers of parts are geometric but end at kMostLinks, for which there is no conjugate prior.
  const double was = density.theta().split_more, splits = rates.split_more.no - Rates().split_more.no;
  const auto log_none_cut = [](double more) { return std::log1p(-std::pow(more, mcmc::kMostLinks - 1)); };
  if (std::log1p(-rng.uniform()) >= splits * (log_none_cut(was) - log_none_cut(drawn.split_more)))
    drawn.split_more = was;
  return drawn;
}

std::vector<test::Statistic> of_rates(const SamplerParameters& t) {
  double death = 0, merge = 0, split = 0;
  for (const auto& row : t.outcome) death += row[0], merge += row[3], split += row[2];
  return {{"birth 0", t.birth[0]},
          {"birth", t.birth[1]},
          {"growth of ends", t.growth[0]},
          {"growth inside", t.growth[1]},
          {"growth of junctions", t.growth[2]},
          {"growth of new", t.growth[3]},
          {"first growth", t.first_growth},
          {"death", death},
          {"merge", merge},
          {"split", split},
          {"death alone", t.outcome[0][0]},
          {"split more", t.split_more},
          {"other kind", t.other_kind},
          {"bright", t.kinds[0]},
          {"keep", t.join[2][0]},
          {"connect", t.join[0][1]},
          {"close 0", t.close[0][0]},
          {"close", t.close[1][1]}};
}
std::vector<test::Statistic> of_both(const HiddenGraph& g, const Density& density) {
  auto all = test::statistics(g);
  for (const auto& [name, value] : of_rates(density.theta())) {
    all.push_back({name, value});
    all.push_back({name + " squared", value * value});
  }
  all.push_back({"log density", density.total(g)});
  return all;
}

HiddenGraph forward(const SamplerParameters& theta, core::Rng& rng) {
  return simulate_prior(theta, kJointSize, kJointSize, kJointFrames, kGates, rng);
}

/// Pairs of states and rates: after each `moves` moves new rates, many short chains, each from a pair drawn
/// from both. Their changes are 0 in the mean.
void check_joint(std::uint32_t chains, int rounds, int moves) {
  std::vector<std::vector<double>> change;
  std::vector<std::string> names;
  for (std::uint32_t n = 0; n < chains; ++n) {
    core::Rng rng(41, {n, 0, 0});
    const SamplerParameters theta = Rates().draw(rng);
    const HiddenGraph drawn = forward(theta, rng);
    REQUIRE(std::isfinite(Density(theta).total(drawn)));
    test::FreeChain chain(drawn, theta, kGates, core::Rng(42, {n, 0, 0}));
    const auto was = of_both(chain.state(), chain.density());
    for (int r = 0; r < rounds; ++r) {
      for (int k = 0; k < moves; ++k) chain.step(true);
      chain.set_theta(draw_rates(chain.state(), chain.density(), rng));
    }
    const auto is = of_both(chain.state(), chain.density());
    REQUIRE(std::isfinite(is.back().value));
    change.resize(is.size()), names.resize(is.size());
    for (std::size_t k = 0; k < is.size(); ++k) {
      change[k].push_back(is[k].value - was[k].value);
      names[k] = is[k].name;
    }
  }
  CHECK(names.size() >= 40);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const test::Mean mean = test::mean_of(change[k]);
    INFO(names[k] << " changes by " << mean.value << " +- " << mean.error);
    CHECK(mean.error > 0);
    CHECK(std::abs(test::z_score(mean, {0, 0})) < 4.5);
  }
}

/// Numbers that are ranked. Patches are observed; links, edges, displacements and rates are not.
std::vector<test::Statistic> ranked(const HiddenGraph& g, const Density& density) {
  double links = 0, edges = 0, displacement = 0, parts = 0, deaths = 0;
  for (Index i = 0; i < g.size(); ++i) {
    links += static_cast<double>(g[i].next.size());
    edges += static_cast<double>(g[i].edges.size());
    displacement += g[i].displacement * g[i].displacement;
    if (g[i].frame + 1 == g.frames()) continue;
    parts += outcome(g, i) == mcmc::Outcome::split || outcome(g, i) == mcmc::Outcome::merge;
    deaths += outcome(g, i) == mcmc::Outcome::death;
  }
  auto all = of_rates(density.theta());
  all.push_back({"links", links}), all.push_back({"edges", edges}), all.push_back({"sway", displacement});
  all.push_back({"splits and merges", parts}), all.push_back({"deaths", deaths});
  all.push_back({"log joint", density.total(g) + Rates().log_density(density.theta())});
  return all;
}

/// The truth's place among draws of a chain through it. The chain is reversible, and so the truth may be put
/// at any place of it (Besag & Clifford 1989): ranks are uniform however slowly it mixes.
void check_ranks(std::uint32_t data_sets, int steps) {
  constexpr std::uint32_t kRanks = 20;
  std::vector<std::vector<std::size_t>> counts;
  std::vector<std::string> names;
  for (std::uint32_t n = 0; n < data_sets; ++n) {
    core::Rng rng(43, {n, 0, 0});
    const SamplerParameters truth = Rates().draw(rng);
    const HiddenGraph drawn = forward(truth, rng);
    const auto of_truth = ranked(drawn, Density(truth));
    counts.resize(of_truth.size(), std::vector<std::size_t>(kRanks)), names.resize(of_truth.size());
    std::vector<std::uint32_t> below(of_truth.size()), ties(of_truth.size());
    const std::uint32_t before = rng.below(kRanks);
    for (const bool back : {true, false}) {
      test::FreeChain chain(drawn, truth, kGates, core::Rng(44, {n, back, 0}));
      const std::uint32_t draws = back ? before : kRanks - 1 - before;
      for (std::uint32_t d = 0; d < draws; ++d) {
        for (int k = 0; k < steps; ++k)
          if (rng.below(25) == 0)
            chain.set_theta(draw_rates(chain.state(), chain.density(), rng));
          else
            chain.step(false);
        const auto now = ranked(chain.state(), chain.density());
        for (std::size_t k = 0; k < now.size(); ++k) {
          below[k] += now[k].value < of_truth[k].value;
          ties[k] += now[k].value == of_truth[k].value;
        }
      }
    }
    for (std::size_t k = 0; k < counts.size(); ++k) {
      ++counts[k][below[k] + rng.below(ties[k] + 1)];
      names[k] = of_truth[k].name;
    }
  }
  for (std::size_t k = 0; k < counts.size(); ++k) {
    INFO(names[k]);
    CHECK(test::uniform_p(counts[k]) > 1e-4);
  }
}

}  // namespace

TEST_CASE("States and rates by turns have the law they are drawn from", "[mcmc][joint][heavy]") {
  check_joint(2000, 6, 40);
}
TEST_CASE("Closely: states and rates by turns have the law they are drawn from", "[mcmc][joint][slow]") {
  check_joint(10000, 15, 60);
}

TEST_CASE("The truth ranks anywhere among posterior draws", "[mcmc][joint][heavy]") {
  check_ranks(400, 50);
}
TEST_CASE("Closely: the truth ranks anywhere among posterior draws", "[mcmc][joint][slow]") {
  check_ranks(3000, 100);
}
