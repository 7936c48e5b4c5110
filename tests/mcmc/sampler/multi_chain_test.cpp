// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/multi_chain.hpp"

#include "core/error.hpp"
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
  options.burn_in = options.sweeps = 2;
  return options;
}

}  // namespace

TEST_CASE("Chains from two readings give samples and a model") {
  const auto starts = two_starts();
  const auto found = mcmc::sample_chains(starts, short_runs(), 1, {});
  REQUIRE(found.sampler.samples.size() == 4);
  CHECK(found.sampler.chains == 2);
  REQUIRE(found.last.size() == 2);
  for (const std::size_t k : {0U, 1U}) CHECK(found.last[k] == found.sampler.samples[2 * k + 1]);
  CHECK(found.fitted.model.frames == 16);
  CHECK(found.sampler.samples[0] != found.sampler.samples[2]);
}

TEST_CASE("A chain from nothing is no reading of the clip") {
  auto options = short_runs();
  options.from_nothing = true;
  const auto found = mcmc::sample_chains(two_starts(), options, 1, {});
  CHECK(found.sampler.chains == 3);
  CHECK(found.sampler.samples.size() == 6);
  CHECK(found.last.size() == 2);
}

TEST_CASE("Sampling asks for a start") {
  CHECK(test::contains(
      test::message_of<core::InputError>([&] { mcmc::sample_chains({}, short_runs(), 1, {}); }),
      "there is no start"));
}
