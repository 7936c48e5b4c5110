// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/rate_modifiers.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "mcmc/simulation/synthesize.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/motion_models.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

/// Rows of two strokes in line, 15 px apart, and of one: they unite and come apart.
mcmc::MotionModel uniting_and_parting() {
  auto model = test::empty_model(640, 480);
  test::Frame frame;
  for (int row = 0; row < 11; ++row)
    for (int column = 0; column < 4; ++column) {
      const graph::Point at{20.0 + 155 * column, 20.0 + 42 * row};
      frame.line(test::segment(at, at + graph::Point{50, 0}, 11));
      frame.line(test::segment(at + graph::Point{65, 0}, at + graph::Point{115, 0}, 11));
    }
  model.first = frame.graph();
  for (double& value : model.density.values) value = 1;
  model.rates.reach = 20, model.rates.split_gap = 10;
  model.rates.split = 0.002, model.rates.merge = 0.03;
  return model;
}

mcmc::RateModifiers found_in(const mcmc::MotionModel& model, int frames) {
  const auto motion = mcmc::synthesize(model, frames, 5);
  return mcmc::estimate_rate_modifiers(motion, graph::stroke_events(motion), model.rates);
}

}  // namespace

TEST_CASE("How long ago and how wide have classes", "[circumstances]") {
  const std::vector<std::pair<double, std::size_t>> times{{0, 0},    {3.9, 0}, {4, 1},  {6, 2},  {9, 3},
                                                          {15.9, 3}, {16, 4},  {32, 5}, {1e9, 5}};
  for (const auto& [frames, expected] : times) CHECK(mcmc::elapsed_class(frames) == expected);
  CHECK(mcmc::elapsed_class(std::numeric_limits<double>::infinity()) == 5);
  const std::vector<std::pair<double, std::size_t>> gaps{{0, 0}, {5, 1}, {9.9, 2}, {13, 3}, {14, 4}, {20, 5}};
  for (const auto& [px, expected] : gaps) CHECK(mcmc::gap_class(px) == expected);
  const std::vector<std::pair<double, std::size_t>> turns{{0, 0},  {29, 0}, {31, 1},
                                                          {61, 2}, {91, 3}, {180, 3}};
  for (const auto& [degrees, expected] : turns)
    CHECK(mcmc::turn_class(degrees * std::numbers::pi / 180) == expected);
}

TEST_CASE("The latest happening near a place counts", "[circumstances]") {
  const std::vector<mcmc::PastEvent> all{{{50, 50}, 3}, {{60, 50}, 7}, {{200, 50}, 9}, {{55, 60}, 40}};
  CHECK(mcmc::frames_since(std::span(all).first(3), {50, 50}, 10) == 3);
  CHECK(mcmc::frames_since(std::span(all).first(3), {38, 50}, 10) == 7);  // 22 px from the second
  CHECK(mcmc::frames_since(all, {50, 50}, 10) == 0);                      // what is still to come
  CHECK(std::isinf(mcmc::frames_since(all, {120, 150}, 10)));
}

TEST_CASE("Deaths by age are found as they were made", "[circumstances]") {
  auto model = test::coming_and_going(5, 10, 0.1, 0.06);
  SECTION("as often at any age") {
    const auto found = found_in(model, 400);
    // In a crowd all die more often. The youngest are too young to die in their first frame.
    for (const std::size_t age : {2, 3, 4}) CHECK_THAT(found.death[age], WithinRel(found.death[1], 0.25));
  }
  SECTION("none of the young, many of the middle") {
    model.rates.modifiers.death = {0, 0, 3, 1, 0.5, 0.5};
    const auto found = found_in(model, 400).death;
    CHECK(found[0] < 0.1);
    CHECK(found[1] < 0.1);
    CHECK_THAT(found[2], WithinRel(3 * found[3], 0.2));
    CHECK_THAT(found[4], WithinRel(0.5 * found[3], 0.3));
  }
}

TEST_CASE("A stroke made of others is as old as the oldest of them", "[circumstances]") {
  const auto event = [](graph::EventType type, int frame, std::vector<graph::SubgraphId> before,
                        std::vector<graph::SubgraphId> after) {
    graph::Event made;
    made.type = type, made.frame = frame, made.position = {50, 50};
    made.before = std::move(before), made.after = std::move(after);
    return made;
  };
  // Born in frames 2 and 12, one from frame 20 on, dead in frame 25: 23 frames, not 13.
  const std::vector<graph::Event> events{
      event(graph::EventType::birth, 2, {}, {{1}}), event(graph::EventType::birth, 12, {}, {{2}}),
      event(graph::EventType::merge, 20, {{1}, {2}}, {{3}}), event(graph::EventType::death, 25, {{3}}, {})};
  graph::MotionGraph motion;
  motion.sketch.width = 320, motion.sketch.height = 240;
  motion.sketch.frames.resize(30), motion.links.resize(30);
  auto rates = test::empty_model().rates;
  const auto found = mcmc::estimate_rate_modifiers(motion, events, rates).death;
  // One event where none was expected: (1 + 1) / (1 + 0).
  for (std::size_t age = 0; age < found.size(); ++age)
    CHECK(found[age] == (age == mcmc::elapsed_class(23) ? 2 : 1));
}

TEST_CASE("Partings after unions and unions after partings are found as they were made", "[circumstances]") {
  auto model = uniting_and_parting();
  model.rates.modifiers.separation = {4, 4, 4, 4, 1, 1};
  model.rates.modifiers.unification = {0.2, 0.2, 0.2, 1, 1, 1};
  const auto found = found_in(model, 1500);
  for (const std::size_t soon : {0, 1, 2, 3}) CHECK(found.separation[soon] > 2);
  CHECK_THAT(found.separation[5], WithinRel(1, 0.3));
  for (const std::size_t soon : {0, 1, 2}) CHECK(found.unification[soon] < 0.5);
  CHECK_THAT(found.unification[5], WithinRel(1, 0.35));
}

TEST_CASE("Gaps are bridged by their width", "[circumstances]") {
  auto model = uniting_and_parting();
  model.rates.split_gap = 5;
  model.rates.modifiers.bridging = {1, 1, 1, 1, 0, 1};  // not the 15 px of the beginning
  const auto motion = mcmc::synthesize(model, 200, 5);
  // Only what has come apart unites: never more unions than separations before.
  int apart = 0;
  for (const auto& event : graph::stroke_events(motion)) {
    apart += event.type == graph::EventType::split ? 1 : event.type == graph::EventType::merge ? -1 : 0;
    CHECK(apart >= 0);
  }
}

TEST_CASE("Strokes connect by how far they have to turn and that is found again", "[circumstances]") {
  // Above a long line each time: one that ends towards it, and two whose ends pass it by, at 45° and at 80°.
  auto model = test::empty_model(640, 480);
  test::Frame frame;
  const auto towards = [&](graph::Point end, double degrees) {
    const double turn = degrees * std::numbers::pi / 180;
    const graph::Point back{-std::sin(turn), -std::cos(turn)};
    frame.line(test::segment(end + back * 40, end, 9));
  };
  for (int row = 0; row < 4; ++row) {
    const double y = 110.0 * row + 90;
    frame.line(test::segment({20, y}, {620, y}, 121));
    for (int column = 0; column < 4; ++column) {
      const double x = 40 + 150.0 * column;
      towards({x, y - 12}, 0);
      towards({x + 50, y - 12}, 45);
      towards({x + 110, y - 12}, 80);
    }
  }
  model.first = frame.graph();
  for (double& value : model.density.values) value = 1;
  model.rates.reach = 14, model.rates.connect = 0.02, model.rates.disconnect = 0.02,
  model.rates.disconnect_gap = 12;
  SECTION("alike") {
    const auto found = found_in(model, 1000).turning;
    for (const std::size_t turn : {0, 1, 2}) CHECK_THAT(found[turn], WithinRel(1, 0.35));
  }
  SECTION("only those that end towards the other") {
    model.rates.modifiers.turning = {1, 0, 0, 0};
    const auto found = found_in(model, 1000).turning;
    CHECK(found[0] > 0.6);
    CHECK(found[1] < 0.1);
    CHECK(found[2] < 0.1);
  }
}

TEST_CASE("At twice the speed what depends on time does so twice as soon", "[circumstances]") {
  auto model = test::coming_and_going(5, 10, 0.1, 0.06);
  model.rates.modifiers.death = {0, 0, 0, 1, 1, 1};
  const auto youngest = [](const mcmc::MotionModel& m) {
    const auto motion = mcmc::synthesize(m, 150, 2);
    std::map<graph::SubgraphId, int> born;
    int least = 1000;
    for (const auto& event : graph::stroke_events(motion)) {
      if (event.type == graph::EventType::birth) born[event.after.at(0)] = event.frame;
      if (event.type != graph::EventType::death) continue;
      if (const auto at = born.find(event.before.at(0)); at != born.end())
        least = std::min(least, event.frame - at->second);
    }
    return least;
  };
  CHECK(youngest(model) == 9);
  model.rates.modifiers.pace = 2;
  CHECK(youngest(model) == 5);
}
