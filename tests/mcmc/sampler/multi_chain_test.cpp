// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/multi_chain.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "graph/events/events.hpp"
#include "graph/matching/match.hpp"
#include "graph/matching/time_reversal.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/motion_scene.hpp"

using namespace emberfold;

namespace {

/// Strokes that come and go, matched forwards and backwards.
std::vector<graph::MotionGraph> two_starts() {
  test::Scene scene;
  scene.width = 160, scene.height = 120, scene.frames = 16;
  scene.strokes = test::living(0.6, 0.05, scene.frames, scene.width, scene.height, 3);
  scene.displacement = {1.5, -0.8, 0.3, 30};
  scene.jitter = 0.3;
  const auto sketch = test::make(scene, 4).motion.sketch;
  return {graph::match(sketch, {}), graph::reverse_time(graph::match(graph::reverse_time(sketch), {}))};
}

mcmc::InferOptions short_runs() {
  mcmc::InferOptions options;
  options.burn_in = options.sweeps = 4, options.samples = 2;
  return options;
}

const std::vector<bool> kForwardsAndBackwards = {false, true};

}  // namespace

TEST_CASE("A clip run backwards has its own chains and the reversed events") {
  const auto starts = two_starts();
  const auto there = mcmc::sample_chains(starts, kForwardsAndBackwards, short_runs(), 1, {});
  const auto back = mcmc::sample_chains({graph::reverse_time(starts[1]), graph::reverse_time(starts[0])},
                                        kForwardsAndBackwards, short_runs(), 1, {});
  REQUIRE(there.sampler.samples.size() == 4);
  CHECK(there.sampler.chains == 2);
  for (const auto& trace : there.sampler.traces) {
    REQUIRE(trace.chains.size() == 2);
    CHECK(trace.chains[0].size() == 8);
    CHECK(back.sampler.traces[std::size_t(&trace - there.sampler.traces.data())].chains[1] ==
          trace.chains[0]);
  }
  CHECK(back.sampler.proposals == there.sampler.proposals);
  REQUIRE(there.last.size() == 2);
  for (const std::size_t k : {0U, 1U}) {
    CHECK(there.last[k] == there.sampler.samples[2 * k + 1]);
    auto reversed = graph::reverse_time(graph::stroke_events(back.last[1 - k]), 16);
    auto events = graph::stroke_events(there.last[k]);
    CHECK(events.size() >= 5);
    for (auto* list : {&reversed, &events})  // strokes are named in order of appearance
      for (auto& event : *list) event.before.clear(), event.after.clear();
    CHECK(reversed == events);
  }
}

TEST_CASE("Sampling asks for a reading of each start") {
  CHECK(test::contains(
      test::message_of<core::InputError>([&] { mcmc::sample_chains({}, {}, short_runs(), 1, {}); }),
      "0 starts of 0 readings"));
  CHECK(test::contains(test::message_of<core::InputError>([&] {
                         mcmc::sample_chains(two_starts(), {false, true, false}, short_runs(), 1, {});
                       }),
                       "2 starts of 3 readings"));
}
