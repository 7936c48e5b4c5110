// SPDX-License-Identifier: Apache-2.0
#include "mcmc/simulation/event_statistics.hpp"

#include "core/error.hpp"
#include "mcmc/simulation/rate_calibration.hpp"
#include "mcmc/simulation/simulation_step.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/motion_models.hpp"

using namespace emberfold;
using namespace emberfold::test;

TEST_CASE("A census counts what frames show", "[census]") {
  graph::MotionGraph motion;
  motion.sketch.width = 320, motion.sketch.height = 240;
  test::Frame one, two;
  one.line(test::segment({20, 20}, {60, 20}, 9));
  two.line(test::segment({20, 20}, {60, 20}, 9));
  two.line(test::segment({20, 80}, {30, 80}, 3));
  motion.sketch.append(one.graph());
  motion.sketch.append(two.graph());
  motion.links.resize(2);
  const std::array<graph::Event, 1> events{graph::Event{}};
  const auto found = mcmc::event_statistics(motion, events);
  CHECK(found.patches == 10.5);
  CHECK(found.strokes == std::array<double, mcmc::kSizeClasses>{0.5, 0, 1, 0, 0, 0, 0});
  CHECK(found.events[static_cast<std::size_t>(events[0].type)] == 1);
  motion.sketch.frames.pop_back();
  CHECK_THROWS_AS(mcmc::event_statistics(motion, {}), core::InputError);
}

TEST_CASE("Reconciled events make as many strokes as they take", "[census]") {
  mcmc::EventStatistics statistics;
  statistics.events = {2.2, 2.6, 0.2, 0.1, 0.4, 0.5};
  const auto was = statistics.events;
  reconcile_event_rates(statistics);
  const auto& e = statistics.events;
  CHECK_THAT(e[0] + e[2] + e[5] - e[1] - e[3] - e[4], WithinAbs(0, 1e-12));
  // To first order by the same share each, up or down.
  const double share = e[0] / was[0] - 1;
  CHECK(share > 0);
  for (const std::size_t i : {2, 5}) CHECK_THAT(e[i] / was[i] - 1, WithinAbs(share, 1e-12));
  for (const std::size_t i : {1, 3, 4}) CHECK_THAT(e[i] / was[i] - 1, WithinAbs(-share, 1e-12));
  reconcile_event_rates(statistics);
  for (std::size_t i = 0; i < 6; ++i) CHECK_THAT(statistics.events[i], WithinAbs(e[i], 1e-12));
  mcmc::EventStatistics none;
  reconcile_event_rates(none);
  CHECK(none.events == std::array<double, 6>{});
}

TEST_CASE("A model can be balanced to what is wanted", "[census][heavy]") {
  auto model = test::empty_model();
  for (int i = 0; i < 12; ++i) {
    const int column = i % 4, row = i / 4;
    model.exemplars.push_back(
        {test::straight(i % 2 == 0 ? 6 : 12, 0.5 * i), {40 + 75.0 * column, 50 + 70.0 * row}, 8});
  }
  model.rates.birth_by_size = {0, 0.5, 0.5, 0, 0, 0, 0};
  for (double& value : model.rates.birth.values) value = 0.3 / (320 * 240);
  model.rates.death_by_size.fill(0.1);
  for (double& value : model.density.values) value = 0.6;
  mcmc::EventStatistics wanted;
  wanted.strokes = {0, 12, 8, 0, 0, 0, 0};
  wanted.events = {0.7, 0.9, 0, 0, 0, 0};
  wanted.patches = 12 * 6 + 8 * 12;
  mcmc::calibrate_rates(model, wanted, 3, {});
  auto particles = mcmc::detail::initial_strokes(model, 4);
  (void)mcmc::detail::simulate_statistics(particles, model, 4, 1, 200);
  const auto found = mcmc::detail::simulate_statistics(particles, model, 4, 201, 2000);
  CHECK_THAT(found.events[0], WithinAbs(0.8, 0.12));  // births and deaths are reconciled
  CHECK_THAT(found.events[1], WithinAbs(0.8, 0.12));
  CHECK_THAT(found.strokes[1], WithinAbs(12, 2.5));
  CHECK_THAT(found.strokes[2], WithinAbs(8, 2.5));
}

TEST_CASE("A clip begins as it was seen or as it usually is", "[synthesis]") {
  auto model = test::empty_model();
  test::Frame frame;
  frame.line(test::segment({100, 100}, {140, 100}, 9));
  model.first = frame.graph();
  model.displacement = {1.2, -0.4, 0, 1, 20, 0};
  model.contrast = {0.6, 0.2, 0, 0.3, 20, 0};
  SECTION("data: the first frame is the one that was seen, and moves on") {
    mcmc::Synthesis synthesis(model, 1);
    const auto seen = synthesis.next(), next = synthesis.next();
    for (std::uint32_t v = 0; v < 9; ++v) {
      CHECK(graph::distance(seen.patch(v).position, model.first.patch(v).position) < 1e-9);
      CHECK_THAT(seen.patch(v).contrast, WithinAbs(40, 1e-9));
      CHECK(graph::distance(next.patch(v).position, seen.patch(v).position) > 0.01);
    }
  }
  SECTION("stationary: nothing is left of it") {
    mcmc::Synthesis synthesis(model, 1, mcmc::Start::stationary);
    const auto moved = synthesis.next();
    CHECK(graph::distance(moved.patch(0).position, model.first.patch(0).position) > 0.1);
    // And of strokes that come and go, none of the first.
    model.rates.death_by_size.fill(0.2);
    model.exemplars = {{test::straight(5), {250, 200}, 20}};
    model.rates.birth_by_size = {0, 1, 0, 0, 0, 0, 0};
    for (double& value : model.rates.birth.values) value = 0.5 / (320 * 240);
    mcmc::Synthesis other(model, 1, mcmc::Start::stationary);
    const auto graph = other.next();
    for (const auto& vertex : graph.vertices()) CHECK(vertex.patch.position.x > 200);
  }
}
