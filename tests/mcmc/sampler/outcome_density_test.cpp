// SPDX-License-Identifier: Apache-2.0
// The terms of what becomes of patches, and which states may be.
#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "mcmc/sampler/density.hpp"
#include "tests/mcmc/formulas.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::formula;
using namespace emberfold::test;

TEST_CASE("The place on the death map scales a chance of death up to a limit", "[mcmc][density]") {
  const SamplerParameters t = theta();
  const double at_rest = t.outcome[0][0];
  for (std::size_t place = 0; place < mcmc::kPlaces; ++place) {
    HiddenGraph g(60, 40, 2, {12, 12, 0});
    const Index v = shown(g, 0, patch(30, 20));
    g.set_map_values(v, 0, static_cast<std::uint8_t>(place), {});
    const double death = std::min(0.95, at_rest * std::pow(2, (static_cast<double>(place) - 4) / 2));
    const double merge = t.outcome[0][3] * (1 - death) / (1 - at_rest);
    CHECK_THAT(Density(t).log_outcome(g, v), WithinAbs(std::log(death / (1 - merge)), kTight));
    // Going on takes its share of what is left.
    g.link(v, shown(g, 1, patch(30, 21)));
    const double going = t.outcome[0][1] * (1 - death) / (1 - at_rest);
    CHECK_THAT(Density(t).log_outcome(g, v), WithinAbs(std::log(going / (1 - merge)), kTight));
  }
}

TEST_CASE("A split has several heirs that spread wider", "[mcmc][density]") {
  const SamplerParameters t = theta();
  HiddenGraph g(80, 80, 2, {12, 12, 0});
  const Index v = shown(g, 0, patch(40, 40, 0));
  std::vector<Index> heirs;
  const Density density(t);
  for (int parts = 1; parts <= 4; ++parts) {
    heirs.push_back(shown(g, 1, patch(38.0 + parts, 41, 0)));
    g.link(v, heirs.back());
    if (parts == 1) continue;
    double factorial = 1;
    for (int k = 2; k <= parts; ++k) factorial *= k;
    const double p = chance(t, 0, 0, mcmc::Outcome::split, false) * (1 - t.split_more) *
                     std::pow(t.split_more, parts - 2) / (1 - std::pow(t.split_more, 5)) * factorial;
    CHECK(outcome(g, v) == mcmc::Outcome::split);
    CHECK_THAT(density.log_outcome(g, v), WithinAbs(std::log(p), kTight));
    const double lag =
        std::sqrt(stationary(t) * (1 - std::pow(t.displacement.a1 / (1 - t.displacement.a2), 2)));
    CHECK_THAT(
        density.log_birth_or_survival(g, heirs[0]),
        WithinAbs(std::log(normal(-1, t.along * t.split_spread) * normal(1, t.across * t.split_spread) *
                           normal(0, lag) * erring(turned, 0, t.turn) * erring(normal, 0, t.flicker)),
                  kTight));
  }
}

TEST_CASE("A patch merges into one that an earlier neighbour goes on as", "[mcmc][density]") {
  const SamplerParameters t = theta();
  const Density density(t);
  HiddenGraph g(80, 80, 2, {30, 12, 0});
  // In order u, v, x; u and v lie within 7 px of x, u and v of each other.
  const Index u = shown(g, 0, patch(40, 40)), v = shown(g, 0, patch(44, 40)), x = shown(g, 0, patch(46, 42));
  const Index w = shown(g, 1, patch(41, 40)), y = shown(g, 1, patch(44, 41));
  g.link(u, w);
  CHECK(mcmc::merge_targets(g, v) == 1);
  CHECK(mcmc::merge_targets(g, x) == 1);
  CHECK(mcmc::merge_targets(g, u) == 0);
  CHECK_THAT(density.log_outcome(g, v),
             WithinAbs(std::log(chance(t, 0, 0, mcmc::Outcome::death, true)), kTight));
  g.link(v, y);
  CHECK(mcmc::merge_targets(g, x) == 2);
  g.link(x, y);
  CHECK(mcmc::parent(g, y) == v);
  CHECK(outcome(g, v) == mcmc::Outcome::survival);
  CHECK(outcome(g, x) == mcmc::Outcome::merge);
  CHECK_THAT(density.log_outcome(g, x),
             WithinAbs(std::log(chance(t, 0, 0, mcmc::Outcome::merge, true) / 2), kTight));
  CHECK_THAT(density.log_outcome(g, u),
             WithinAbs(std::log(chance(t, 0, 0, mcmc::Outcome::survival, false)), kTight));
  // y comes from v alone.
  HiddenGraph without = g;
  without.unlink(x, y);
  CHECK(density.log_birth_or_survival(g, y) == density.log_birth_or_survival(without, y));
  // From too far away nothing merges.
  HiddenGraph far(80, 80, 2, {30, 20, 0});
  const Index a = shown(far, 0, patch(40, 40)), b = shown(far, 0, patch(48, 40));
  const Index c = shown(far, 1, patch(44, 40));
  far.link(a, c), far.link(b, c);
  CHECK(density.total(far) == -std::numeric_limits<double>::infinity());
}

TEST_CASE("A patch is told what became of its earlier neighbours", "[mcmc][density]") {
  const SamplerParameters t = theta();
  const Density density(t);
  HiddenGraph g(80, 80, 2, {7, 12, 0});
  test::row(g, 0, 3, 40, 40);
  const Index w = shown(g, 1, patch(40, 41));
  CHECK_THAT(density.log_outcome(g, 0),
             WithinAbs(std::log(chance(t, 1, 0, mcmc::Outcome::death, false)), kTight));
  CHECK_THAT(density.log_outcome(g, 1),
             WithinAbs(std::log(chance(t, 2, 2, mcmc::Outcome::death, false)), kTight));
  g.link(0, w);
  CHECK_THAT(density.log_outcome(g, 1),
             WithinAbs(std::log(chance(t, 2, 1, mcmc::Outcome::death, true)), kTight));
  CHECK_THAT(density.log_outcome(g, 2),
             WithinAbs(std::log(chance(t, 1, 2, mcmc::Outcome::death, false)), kTight));
  HiddenGraph edge(80, 80, 2, {7, 12, 0});
  shown(edge, 0, patch(72, 40));
  CHECK_THAT(density.log_outcome(edge, 0),
             WithinAbs(std::log(chance(t, 0, 0, mcmc::Outcome::death, false, true)), kTight));
}

TEST_CASE("Link moves reach as many star forests as there are", "[mcmc][density]") {
  // All of a frame lie within 7 px, so that each can merge into each.
  struct Case {
    int before, after;
    std::size_t forests;
  };
  for (const auto& [m, n, forests] :
       {Case{2, 2, 11}, {2, 3, 30}, {2, 4, 85}, {3, 3, 103}, {3, 4, 356}, {4, 3, 356}}) {
    HiddenGraph g(60, 60, 2, {12, 12, 0});
    for (int k = 0; k < m; ++k) shown(g, 0, patch(30 + 2 * k, 30));
    for (int k = 0; k < n; ++k) shown(g, 1, patch(30 + 2 * k, 30.5));
    const auto report = check_ratios(g, Density(theta()), {test::checked(test::move_named("link, unlink"))});
    INFO(m << " and " << n);
    CHECK(report.complete);
    CHECK(report.states == forests);
    CHECK(report.classes == 1);
  }
}

TEST_CASE("Link moves reach just the star forests that the density lets be", "[mcmc][density]") {
  // Four before, too far from end to end to merge; every set of pairs is tried.
  const int m = 4, n = 3;
  HiddenGraph g(60, 60, 2, {20, 20, 0});
  for (int k = 0; k < m; ++k) shown(g, 0, patch(25 + 3.5 * k, 30));
  for (int k = 0; k < n; ++k) shown(g, 1, patch(28 + 3 * k, 30.5));
  const Density density(theta());
  std::size_t possible = 0, forests = 0;
  for (unsigned set = 0; set < 1U << (m * n); ++set) {
    HiddenGraph state = g;
    bool forest = true;
    for (int k = 0; k < m * n && forest; ++k) {
      const auto v = static_cast<Index>(k / n), w = static_cast<Index>(m + k % n);
      if ((set >> k & 1U) == 0) continue;
      forest = state.can_link(v, w);
      if (forest) state.link(v, w);
    }
    forests += forest;
    possible += forest && std::isfinite(density.total(state));
  }
  CHECK(forests == 356);
  CHECK(possible < 356);
  const auto report = check_ratios(g, density, {test::checked(test::move_named("link, unlink"))});
  CHECK(report.states == possible);
}

TEST_CASE("Theta's numbers out of range are named", "[mcmc][density]") {
  REQUIRE_NOTHROW(mcmc::validate(mcmc::default_parameters(300, 76800)));
  const auto refuse = [](auto change, const std::string& field) {
    auto t = mcmc::default_parameters(300, 76800);
    change(t);
    try {
      mcmc::validate(t);
      FAIL_CHECK(field << " was accepted");
    } catch (const core::InputError& error) {
      CHECK(std::string(error.what()).find(field) != std::string::npos);
    }
  };
  refuse([](SamplerParameters& t) { t.outcome[3][1] += 0.1; }, "outcome");
  refuse([](SamplerParameters& t) { t.outcome[3][1] = 0; }, "outcome");
  refuse([](SamplerParameters& t) { t.join[2][5] = 1; }, "join");
  refuse([](SamplerParameters& t) { t.join[0][0] = 0; }, "join");
  refuse([](SamplerParameters& t) { t.close[1][2] = -0.5; }, "close");
  refuse([](SamplerParameters& t) { t.split_more = 1; }, "split_more");
  refuse([](SamplerParameters& t) { t.branch = 0; }, "branch");
  refuse([](SamplerParameters& t) { t.other_kind = 0; }, "other_kind");
  refuse([](SamplerParameters& t) { t.kinds[2] = 0; }, "kinds");
  refuse([](SamplerParameters& t) { t.birth[0] = 0; }, "birth");
  refuse([](SamplerParameters& t) { t.growth[2] = std::nan(""); }, "growth");
  refuse([](SamplerParameters& t) { t.first_growth = -1; }, "first_growth");
  refuse([](SamplerParameters& t) { t.across = 0; }, "across");
  refuse([](SamplerParameters& t) { t.along = 0; }, "along");
  refuse([](SamplerParameters& t) { t.turn = 0; }, "turn");
  refuse([](SamplerParameters& t) { t.flicker = 0; }, "flicker");
  refuse([](SamplerParameters& t) { t.split_spread = 0; }, "split_spread");
  refuse([](SamplerParameters& t) { t.new_contrast_sd = 0; }, "new_contrast_sd");
  refuse([](SamplerParameters& t) { t.step = 0; }, "step");
  refuse([](SamplerParameters& t) { t.step_sd = 0; }, "step_sd");
  refuse([](SamplerParameters& t) { t.side_sd = 0; }, "side_sd");
  refuse([](SamplerParameters& t) { t.bend_sd = 0; }, "bend_sd");
  refuse([](SamplerParameters& t) { t.grown_contrast_sd = 0; }, "grown_contrast_sd");
  refuse([](SamplerParameters& t) { t.branch_reach = 0; }, "branch_reach");
  refuse([](SamplerParameters& t) { t.displacement.noise = 0; }, "noise");
  refuse([](SamplerParameters& t) { t.displacement.a1 = 2; }, "sway");
}
