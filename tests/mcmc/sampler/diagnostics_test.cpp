// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/diagnostics.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/statistics.hpp"

using namespace emberfold;
using namespace emberfold::test;
using Chains = std::vector<std::vector<double>>;

namespace {

/// Stationary AR(1) chains of variance 1; phi = 0: independent draws.
Chains made_chains(std::size_t count, std::size_t length, double phi, std::uint64_t seed) {
  Chains chains(count);
  for (std::size_t c = 0; c < count; ++c) {
    core::Rng rng(seed, {static_cast<std::uint32_t>(c)});
    double x = rng.normal();
    for (std::size_t i = 0; i < length; ++i, x = phi * x + std::sqrt(1 - phi * phi) * rng.normal())
      chains[c].push_back(x);
  }
  return chains;
}

Chains changed(Chains chains, const std::function<double(std::size_t, double)>& change) {
  for (std::size_t c = 0; c < chains.size(); ++c)
    for (double& x : chains[c]) x = change(c, x);
  return chains;
}

// ---- the same quantities by their definitions, slowly

double naive_quantile_of_normal(double p) {
  double low = -40, high = 40;
  for (int i = 0; i < 200; ++i) (test::normal_cdf((low + high) / 2) < p ? low : high) = (low + high) / 2;
  return (low + high) / 2;
}

Chains naive_halves(const Chains& chains) {
  Chains split;
  for (const auto& chain : chains) {
    std::vector<double> first, second;
    for (std::size_t i = 0; i < chain.size(); ++i) {
      if (2 * i + 1 < chain.size()) first.push_back(chain[i]);
      if (2 * i + 1 > chain.size()) second.push_back(chain[i]);
    }
    split.push_back(first);
    split.push_back(second);
  }
  return split;
}

Chains naive_scores(const Chains& chains) {
  double count = 0;
  for (const auto& chain : chains) count += static_cast<double>(chain.size());
  return changed(chains, [&](std::size_t, double x) {
    double below = 0, equal = 0;
    for (const auto& chain : chains)
      for (const double y : chain) below += y < x ? 1 : 0, equal += y == x ? 1 : 0;
    return naive_quantile_of_normal((below + (equal + 1) / 2 - 0.375) / (count + 0.25));
  });
}

struct Naive {
  double within = 0, pooled = 0, size = 0;
  [[nodiscard]] double rhat() const { return std::sqrt(pooled / within); }
};

Naive naive(const Chains& chains) {
  const auto m = static_cast<double>(chains.size()), n = static_cast<double>(chains[0].size());
  std::vector<double> means;
  double overall = 0;
  for (const auto& chain : chains) {
    double sum = 0;
    for (const double x : chain) sum += x;
    means.push_back(sum / n);
    overall += sum / n / m;
  }
  Naive result;
  double between = 0;
  for (const double v : means) between += n * (v - overall) * (v - overall) / (m - 1);
  std::vector<double> covariance;
  for (std::size_t lag = 0; lag < chains[0].size(); ++lag) {
    double sum = 0;
    for (std::size_t c = 0; c < chains.size(); ++c)
      for (std::size_t i = lag; i < chains[c].size(); ++i)
        sum += (chains[c][i] - means[c]) * (chains[c][i - lag] - means[c]);
    covariance.push_back(sum / (m * n));
  }
  result.within = covariance[0] * n / (n - 1);
  result.pooled = covariance[0] + between / n;
  std::vector<double> rho{1};
  for (std::size_t lag = 1; lag < covariance.size(); ++lag)
    rho.push_back(1 - (result.within - covariance[lag]) / result.pooled);
  std::vector<double> pairs;
  std::size_t k = 0;
  for (; 2 * k + 1 < rho.size() && rho[2 * k] + rho[2 * k + 1] > 0; ++k) {
    pairs.push_back(rho[2 * k] + rho[2 * k + 1]);
    if (k > 0) pairs[k] = std::min(pairs[k], pairs[k - 1]);
  }
  double time = -1;
  for (const double pair : pairs) time += 2 * pair;
  if (2 * k + 1 < rho.size() && rho[2 * k] > 0) time += std::min(rho[2 * k], pairs.back());
  result.size = m * n / std::max(time, 1 / std::log10(m * n));
  return result;
}

double naive_quantile(const Chains& chains, double share) {
  std::vector<double> all;
  for (const auto& chain : chains) all.insert(all.end(), chain.begin(), chain.end());
  std::ranges::sort(all);
  const double at = share * static_cast<double>(all.size() - 1), low = std::floor(at);
  const auto i = static_cast<std::size_t>(low);
  return i + 1 < all.size() ? all[i] * (1 - at + low) + all[i + 1] * (at - low) : all[i];
}

}  // namespace

TEST_CASE("diagnoses are what their definitions say, by a slow computation") {
  struct Kind {
    const char* name;
    Chains chains;
  };
  const std::vector<Kind> kinds = {
      {"correlated", made_chains(4, 60, 0.8, 1)},
      {"alternating, of odd length", made_chains(2, 51, -0.6, 2)},
      {"one chain, skewed", changed(made_chains(1, 80, 0.5, 3), [](auto, double x) { return std::exp(x); })},
      {"shifted", changed(made_chains(3, 40, 0, 4), [](std::size_t c, double x) { return x + double(c); })},
      {"rounded, with many ties",
       changed(made_chains(4, 50, 0.7, 5), [](auto, double x) { return std::round(x); })}};
  for (const auto& [name, chains] : kinds) {
    INFO(name);
    const auto found = mcmc::diagnose(chains);
    const auto split = naive_halves(chains);
    const auto bulk = naive(naive_scores(split));
    const double median = naive_quantile(split, 0.5);
    const auto fold =
        naive(naive_scores(changed(split, [&](auto, double x) { return std::abs(x - median); })));
    CHECK_THAT(found.rhat, WithinRel(std::max(bulk.rhat(), fold.rhat()), 1e-9));
    CHECK_THAT(found.bulk_ess, WithinRel(bulk.size, 1e-9));
    const auto tail = [&](double share) {
      const double bound = naive_quantile(split, share);
      return naive(changed(split, [&](auto, double x) { return x <= bound ? 1.0 : 0.0; })).size;
    };
    CHECK_THAT(found.tail_ess, WithinRel(std::min(tail(0.05), tail(0.95)), 1e-9));
    CHECK_THAT(mcmc::effective_size(chains), WithinRel(naive(split).size, 1e-9));
    CHECK_THAT(found.error, WithinRel(found.deviation / std::sqrt(naive(split).size), 1e-9));
  }
}

TEST_CASE("independent draws count each, and their chains agree") {
  double bulk = 0, tail = 0, rhat = 0;
  constexpr int kRuns = 20;
  for (int run = 0; run < kRuns; ++run) {
    const auto found = mcmc::diagnose(made_chains(4, 500, 0, 100 + static_cast<std::uint64_t>(run)));
    CHECK(found.rhat < 1.02);
    CHECK_THAT(found.mean, WithinAbs(0, 6 * found.error));
    CHECK_THAT(found.error, WithinRel(1 / std::sqrt(2000), 0.25));
    bulk += found.bulk_ess / kRuns, tail += found.tail_ess / kRuns, rhat += found.rhat / kRuns;
  }
  CHECK_THAT(bulk, WithinRel(2000, 0.05));
  CHECK_THAT(tail, WithinRel(2000, 0.08));
  CHECK_THAT(rhat, WithinAbs(1.001, 0.003));
}

TEST_CASE("an auto-regression has the effective size that is known of it") {
  for (const double phi : {0.3, 0.6, 0.9, -0.4}) {
    INFO("phi " << phi);
    constexpr double kDraws = 4 * 4000;
    double bulk = 0, plain = 0;
    constexpr int kRuns = 8;
    for (int run = 0; run < kRuns; ++run) {
      const auto chains = made_chains(4, 4000, phi, 200 + static_cast<std::uint64_t>(run));
      bulk += mcmc::diagnose(chains).bulk_ess / kRuns;
      plain += mcmc::effective_size(chains) / kRuns;
    }
    const double known = kDraws * (1 - phi) / (1 + phi);
    CHECK_THAT(bulk, WithinRel(known, 0.08));
    CHECK_THAT(plain, WithinRel(known, 0.08));
  }
}

TEST_CASE("chains that are not of one law are seen") {
  const auto same = made_chains(4, 400, 0.3, 7);
  CHECK(mcmc::diagnose(same).rhat < 1.03);
  const auto shifted = changed(same, [](std::size_t c, double x) { return c == 2 ? x + 1.5 : x; });
  CHECK(mcmc::diagnose(shifted).rhat > 1.1);
  CHECK(mcmc::diagnose(shifted).bulk_ess < 0.1 * mcmc::diagnose(same).bulk_ess);

  // same middle, another spread: the means do not show it, the folded ranks do
  const auto spread = changed(same, [](std::size_t c, double x) { return c < 2 ? x : 4 * x; });
  CHECK(naive(naive_scores(naive_halves(spread))).rhat() < 1.03);
  CHECK(mcmc::diagnose(spread).rhat > 1.1);

  // a single chain that has not come to rest
  auto drifting = made_chains(1, 400, 0, 8);
  for (std::size_t i = 0; i < 400; ++i) drifting[0][i] += 0.005 * static_cast<double>(i);
  CHECK(mcmc::diagnose(drifting).rhat > 1.1);
}

TEST_CASE("rank normalisation: a monotone change of the numbers changes nothing but their mean") {
  const auto chains = made_chains(3, 200, 0.5, 9);
  // cubes keep the order; shares of the indicators' bounds are between draws
  const auto cubes = changed(chains, [](auto, double x) { return x * x * x; });
  const auto a = mcmc::diagnose(chains), b = mcmc::diagnose(cubes);
  CHECK(a.bulk_ess == b.bulk_ess);
  CHECK(a.tail_ess == b.tail_ess);
  // draws without a finite variance are no harm
  const auto heavy = changed(made_chains(4, 500, 0, 10), [](auto, double x) {
    return std::tan(std::acos(-1) * (test::normal_cdf(x) - 0.5));
  });
  CHECK(mcmc::diagnose(heavy).rhat < 1.02);
  CHECK(mcmc::diagnose(heavy).bulk_ess > 1500);
}

TEST_CASE("order of the chains is of no account, the order of draws is") {
  auto chains = made_chains(4, 100, 0.8, 11);
  const auto before = mcmc::diagnose(chains);
  std::ranges::reverse(chains);
  const auto after = mcmc::diagnose(chains);
  CHECK_THAT(after.rhat, WithinRel(before.rhat, 1e-12));
  CHECK_THAT(after.bulk_ess, WithinRel(before.bulk_ess, 1e-12));
  for (auto& chain : chains) std::ranges::sort(chain);
  CHECK(mcmc::diagnose(chains).rhat > 1.5);
}

TEST_CASE("indicators of an event have an effective size") {
  // a two-state chain that stays with probability stay: its autocorrelation at lag k is (2 stay − 1)^k
  constexpr double kStay = 0.8, kDraws = 4 * 5000;
  Chains chains(4);
  for (std::size_t c = 0; c < 4; ++c) {
    core::Rng rng(12, {static_cast<std::uint32_t>(c)});
    double x = rng.uniform() < 0.5 ? 0 : 1;
    for (int i = 0; i < 5000; ++i, x = rng.uniform() < kStay ? x : 1 - x) chains[c].push_back(x);
  }
  const double known = kDraws * (1 - 0.6) / (1 + 0.6);
  CHECK_THAT(mcmc::effective_size(chains), WithinRel(known, 0.1));
  const auto found = mcmc::diagnose(chains);
  CHECK_THAT(found.bulk_ess, WithinRel(known, 0.1));
  CHECK(found.rhat < 1.01);
  // the 95 % quantile is 1, where all are: the other indicator alone counts
  CHECK_THAT(found.tail_ess, WithinRel(known, 0.1));

  // an event that one chain has and the others have not
  Chains apart(4, std::vector<double>(100, 0.0));
  apart[1].assign(100, 1.0);
  CHECK(std::isinf(mcmc::diagnose(apart).rhat));
  CHECK(mcmc::effective_size(apart) < 8);
}

TEST_CASE("what cannot be told is not a number") {
  const auto unknown = [](const mcmc::Diagnosis& d) {
    return std::isnan(d.rhat) && std::isnan(d.bulk_ess) && std::isnan(d.tail_ess);
  };
  for (const Chains& nothing : {Chains{}, Chains{{}}, Chains{{}, {}}}) {
    CHECK(unknown(mcmc::diagnose(nothing)));
    CHECK(std::isnan(mcmc::diagnose(nothing).mean));
    CHECK(std::isnan(mcmc::effective_size(nothing)));
  }
  const Chains few{{1, 2, 3}, {2, 4, 6}};
  CHECK(unknown(mcmc::diagnose(few)));
  CHECK(mcmc::diagnose(few).mean == 3);
  CHECK_THAT(mcmc::diagnose(few).deviation, WithinRel(std::sqrt(16.0 / 5), 1e-12));
  CHECK(std::isnan(mcmc::diagnose(few).error));
  CHECK(std::isnan(mcmc::effective_size(few)));

  const Chains still(3, std::vector<double>(50, 0.1));
  CHECK(unknown(mcmc::diagnose(still)));
  CHECK(mcmc::diagnose(still).mean == 0.1);
  CHECK(mcmc::diagnose(still).deviation == 0);
  CHECK(mcmc::diagnose(still).error == 0);
  CHECK(std::isnan(mcmc::effective_size(still)));

  for (const double odd : {std::numeric_limits<double>::infinity(), std::nan("")}) {
    auto chains = made_chains(2, 20, 0, 13);
    chains[1][7] = odd;
    CHECK(unknown(mcmc::diagnose(chains)));
    CHECK(std::isnan(mcmc::diagnose(chains).mean));
    CHECK(std::isnan(mcmc::effective_size(chains)));
  }
  const auto text = test::message_of<core::InputError>([] {
    (void)mcmc::diagnose(Chains{{1, 2, 3, 4}, {1, 2, 3}});
  });
  CHECK(test::contains(text, "chain 1 has 3 draws, chain 0 has 4"));
}

TEST_CASE("four draws are enough to say something") {
  const auto found = mcmc::diagnose(Chains{{1, 2, 3, 5}});
  CHECK(std::isfinite(found.rhat));
  CHECK(found.rhat > 1);
  CHECK(found.bulk_ess > 0);
}
