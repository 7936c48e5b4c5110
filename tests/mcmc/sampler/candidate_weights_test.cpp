// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/candidate_weights.hpp"

#include <cmath>

#include "mcmc/sampler/prior.hpp"
#include "tests/mcmc/sampler/small_models.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/motion_models.hpp"

using namespace emberfold;
using namespace emberfold::test;

TEST_CASE("Candidates have the births, deaths and drift of their places", "[mcmc]") {
  auto model = empty_model(64, 48);  // 4 × 3 cells
  for (std::size_t k = 0; k < 12; ++k) {
    model.rates.birth.values[k] = 1 + static_cast<double>(k);  // 6.5 on average
    model.drift_x.values[k] = static_cast<double>(k), model.drift_y.values[k] = -2 * static_cast<double>(k);
  }
  model.rates.death.values = {0.1, 0.25, 0.5, std::sqrt(0.5), 1, std::sqrt(2), 2, std::sqrt(8), 4,
                              9,   1.1,  0.9};
  HiddenGraph g(64, 48, 2, Gates{});
  for (int k = 0; k < 12; ++k) g.add_candidate(0, test::patch(8 + 16 * (k % 4), 8 + 16 * (k / 4)));
  REQUIRE(g.size() == 12);
  mcmc::apply_maps(g, model);
  const int levels[] = {0, 0, 2, 3, 4, 5, 6, 7, 8, 8, 4, 4};  // of √2 each, 4: 1
  for (Index i = 0; i < 12; ++i) {
    CHECK_THAT(g[i].log_birth, WithinAbs(std::log((1.0 + i) / 6.5), 1e-12));
    CHECK(int{g[i].place} == levels[i]);
    CHECK((g[i].drift.x == 1.0 * i && g[i].drift.y == -2.0 * i));
  }
}

TEST_CASE("Patches count a share of their gain, edges as often as the starts have them", "[mcmc]") {
  HiddenGraph g(64, 48, 1, Gates{});
  const double gains[] = {50, 400, -30};
  for (int k = 0; k < 3; ++k) {
    graph::Patch one = test::patch(10 + 5 * k, 20);
    one.gain = static_cast<float>(gains[k]);
    g.add_candidate(0, one);
  }
  std::vector<HiddenGraph> states(3, g);
  for (HiddenGraph& state : states) state.activate(0), state.activate(1);
  states[0].add_edge(0, 1), states[1].add_edge(0, 1);
  states[0].activate(2), states[0].add_edge(1, 2);
  mcmc::weigh_candidates(states, mcmc::SketchEvidence{});
  for (const HiddenGraph& state : states) {
    CHECK_THAT(state[0].evidence, WithinAbs(5, 1e-6));
    CHECK(state[1].evidence == 12);
    CHECK_THAT(state[2].evidence, WithinAbs(-3, 1e-6));
    const auto evidence = [&](Index a, Index b) {
      for (const auto& near : state.neighbours(a))
        if (near.node == b) return double{near.evidence};
      return -1000.0;
    };
    CHECK_THAT(evidence(0, 1), WithinAbs(8 * std::log(2.5 / 1.5), 1e-5));  // two joined, one apart
    CHECK_THAT(evidence(2, 1), WithinAbs(8 * std::log(3.0), 1e-5));   // one joined, and no other has both
    CHECK_THAT(evidence(0, 2), WithinAbs(-8 * std::log(3.0), 1e-5));  // one apart
  }
}

TEST_CASE("Spreads of a prior are wider than those learned, none narrower than a look needs", "[mcmc]") {
  SamplerParameters learned;
  learned.turn = 0.1, learned.flicker = 0.2, learned.across = 0.4;
  learned.step_sd = 0.3, learned.side_sd = 0.2, learned.bend_sd = 0.05, learned.grown_contrast_sd = 0.1;
  const auto wide = mcmc::widen_spreads(learned);
  CHECK_THAT(wide.turn, WithinAbs(0.3, 1e-12));
  CHECK_THAT(wide.flicker, WithinAbs(0.6, 1e-12));
  CHECK(wide.across == 1);
  CHECK_THAT(wide.step_sd, WithinAbs(3, 1e-12));
  CHECK_THAT(wide.side_sd, WithinAbs(2, 1e-12));
  CHECK_THAT(wide.bend_sd, WithinAbs(0.5, 1e-12));
  CHECK_THAT(wide.grown_contrast_sd, WithinAbs(1, 1e-12));
  learned.across = 2, learned.turn = 0.4, learned.bend_sd = 0.3;
  const auto bounded = mcmc::widen_spreads(learned);
  CHECK((bounded.across == 2 && bounded.turn == 0.5 && bounded.bend_sd == 1));
}
