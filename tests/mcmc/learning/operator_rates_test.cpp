// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/operator_rates.hpp"

#include <cmath>
#include <numeric>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "mcmc/learning/drift.hpp"
#include "mcmc/learning/stroke_places.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/motion_scene.hpp"

using namespace emberfold;
using graph::Point;
using Links = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

namespace {

// Links `count` vertices in order, from `first` before and `second` after.
Links same(std::uint32_t first, std::uint32_t second, std::uint32_t count) {
  Links links;
  for (std::uint32_t k = 0; k < count; ++k) links.emplace_back(first + k, second + k);
  return links;
}

mcmc::OperatorCounts counts_of(const graph::MotionGraph& raw) {
  const auto motion = graph::identify(raw);
  return mcmc::count_operators(motion, graph::stroke_events(motion));
}

double total(const mcmc::CellMap& map) {
  return std::accumulate(map.values.begin(), map.values.end(), 0.0);
}

double births_a_frame(const mcmc::CellMap& map) {
  return total(map) * map.cell * map.cell;
}

std::size_t event(graph::EventType type) {
  return static_cast<std::size_t>(type);
}

}  // namespace

TEST_CASE("Sizes in powers of two", "[rates]") {
  for (const auto& [patches, size] : std::vector<std::pair<std::size_t, std::size_t>>{{1, 0},
                                                                                      {4, 0},
                                                                                      {5, 1},
                                                                                      {8, 1},
                                                                                      {9, 2},
                                                                                      {16, 2},
                                                                                      {17, 3},
                                                                                      {32, 3},
                                                                                      {64, 4},
                                                                                      {65, 5},
                                                                                      {128, 5},
                                                                                      {129, 6},
                                                                                      {100000, 6}})
    CHECK(mcmc::size_class(patches) == size);
}

TEST_CASE("A stroke's middle is one of its patches", "[rates]") {
  test::Frame frame;
  frame.line(test::segment({0, 0}, {40, 0}, 9));
  frame.line(test::segment({100, 100}, {100, 150}, 11));
  const auto graph = frame.graph();
  const auto strokes = mcmc::vertices_by_stroke(graph::components(graph));
  REQUIRE(strokes.size() == 2);
  CHECK(strokes[0].size() == 9);
  CHECK(strokes[1].front() == 9);
  CHECK(mcmc::stroke_middle(graph, strokes[0]) == Point{20, 0});
  CHECK(mcmc::stroke_middle(graph, strokes[1]) == Point{100, 125});
}

TEST_CASE("Of equally near patches the first is a stroke's middle, whatever the last digits are", "[rates]") {
  for (int seed = 1; seed <= 50; ++seed) {
    core::Rng rng(static_cast<std::uint64_t>(seed));
    const Point a{rng.uniform(0, 300), rng.uniform(0, 200)},
        b = a + Point{rng.uniform(3, 5), rng.uniform(-4, 4)};
    test::Frame frame;
    frame.line({a, b});
    const auto graph = frame.graph();
    CHECK(mcmc::stroke_middle(graph, mcmc::vertices_by_stroke(graph::components(graph))[0]) ==
          graph.patch(0).position);
  }
}

TEST_CASE("Births and deaths are counted by place and size, and what could have died", "[rates]") {
  // Three frames. A: 9 patches at (40, 40), always there. B: 5 patches at (200, 40), dies after the first
  // frame. C: 12 patches about (100, 200), born in the last.
  test::Frame one, two, three;
  one.line(test::segment({20, 40}, {60, 40}, 9));
  one.line(test::segment({190, 40}, {210, 40}, 5));
  two.line(test::segment({20, 40}, {60, 40}, 9));
  three.line(test::segment({20, 40}, {60, 40}, 9));
  three.line(test::segment({70, 200}, {125, 200}, 12));
  const auto counts =
      counts_of(test::motion({one.graph(), two.graph(), three.graph()}, {same(0, 0, 9), same(0, 0, 9)}));
  CHECK(counts.gaps == 2);
  CHECK(counts.events == std::array<double, 6>{1, 1, 0, 0, 0, 0});
  // In the last frame nothing can happen any more.
  CHECK(counts.death[2].exposure == 2);
  CHECK(counts.death[2].events == 0);
  CHECK(counts.death[1].exposure == 1);
  CHECK(counts.death[1].events == 1);
  for (const std::size_t other : {0, 3, 4, 5, 6}) CHECK(counts.death[other].exposure == 0);
  REQUIRE(counts.births.size() == 2);
  CHECK(total(counts.births[0]) == 0);
  CHECK(total(counts.births[1]) == 1);
  CHECK(counts.births[1].at({97, 200}) == 1);
  CHECK(counts.deaths[0].at({200, 40}) == 1);
  CHECK(total(counts.deaths[0]) + total(counts.deaths[1]) == 1);
  // A stroke of 9 patches is free to split at its middle patch alone.
  CHECK(counts.split.exposure == 2);
  CHECK(counts.disconnect.exposure == 0);
  CHECK(counts.merge.exposure + counts.connect.exposure == 0);
}

TEST_CASE("A split and a merge are counted with their gaps", "[rates]") {
  // 21 patches that lose the two in their middle for a frame: 9 and 10 patches, a gap of 15 px.
  test::Frame whole, pieces;
  whole.line(test::segment({20, 40}, {120, 40}, 21));
  pieces.line(test::segment({20, 40}, {60, 40}, 9));
  pieces.line(test::segment({75, 40}, {120, 40}, 10));
  Links apart = same(0, 0, 9), together = same(0, 0, 9);
  for (std::uint32_t k = 0; k < 10; ++k)
    apart.emplace_back(11 + k, 9 + k), together.emplace_back(9 + k, 11 + k);
  const auto counts = counts_of(test::motion({whole.graph(), pieces.graph(), pieces.graph(), whole.graph()},
                                             {apart, same(0, 0, 19), together}));
  CHECK(counts.events == std::array<double, 6>{0, 0, 1, 1, 0, 0});
  CHECK(counts.split.events == 1);
  CHECK(counts.merge.events == 1);
  // Whole: patches 4 … 16; pieces of 9 and 10 patches: one and two; in two of the three frames they count.
  CHECK(counts.split.exposure == 13 + 2 * 3);
  CHECK(counts.merge.exposure == 2);
  CHECK(counts.split_gap == 15);
  CHECK(counts.reach == 15);
  CHECK(total(counts.separations[0]) == 1);
  CHECK(counts.separations[0].at({67, 40}) == 1);
  CHECK(total(counts.separations[1]) + total(counts.separations[2]) == 0);
}

TEST_CASE("A connect and a disconnect are counted with their sites", "[rates]") {
  // A bar of a T that hangs on for a frame: 6 patches below the middle of 17.
  const auto frame = [](bool joined) {
    test::Frame f;
    f.line(test::segment({20, 50}, {100, 50}, 17));
    if (joined) f.line(test::segment({60, 55}, {60, 60}, 2));
    const auto bar = f.line(test::segment({60, 65}, {60, 90}, 6));
    if (joined) f.edge(8, 17), f.edge(18, bar);
    return f.graph();
  };
  Links connect = same(0, 0, 17), disconnect = same(0, 0, 17);
  for (std::uint32_t k = 0; k < 6; ++k)
    connect.emplace_back(17 + k, 19 + k), disconnect.emplace_back(19 + k, 17 + k);
  const auto counts =
      counts_of(test::motion({frame(false), frame(true), frame(false)}, {connect, disconnect}));
  CHECK(counts.events[event(graph::EventType::connect)] == 1);
  CHECK(counts.events[event(graph::EventType::disconnect)] == 1);
  CHECK(counts.connect.events == 1);
  CHECK(counts.connect.exposure == 1);
  CHECK(counts.disconnect.events == 1);
  CHECK(counts.disconnect.exposure == 3);  // three arms
  CHECK(counts.disconnect_gap == 15);
  CHECK(counts.reach == 15);
  CHECK(total(counts.separations[1]) == 1);
}

TEST_CASE("A known death rate and birth density are recovered", "[rates]") {
  const auto [births, death] = GENERATE(std::pair{0.5, 0.03}, std::pair{2.0, 0.08});
  test::Scene scene;
  scene.frames = 300;
  scene.strokes = test::living(births, death, scene.frames, scene.width, scene.height, 17);
  const auto motion = test::make(scene, 18).motion;
  const auto counts = mcmc::count_operators(motion, graph::stroke_events(motion));
  const auto found = mcmc::estimate_rates(counts);
  CHECK(found.notes.empty());
  // Strokes that cross are two all the same. Poisson: the SD of a count is its root.
  const double seen = births * 299, error = 4 * std::sqrt(seen) / 299;
  CHECK_THAT(births_a_frame(found.rates.birth), Catch::Matchers::WithinAbs(births, error));
  for (const std::size_t size : {1, 2}) {  // of 30 to 70 px: 6 to 15 patches
    const auto& count = counts.death[size];
    REQUIRE(count.exposure > 100);
    const double expected = death * count.exposure;
    CHECK_THAT(found.rates.death_by_size[size] * count.exposure,
               Catch::Matchers::WithinAbs(expected, 4 * std::sqrt(expected)));
  }
  // Nothing else happened, and nothing else is said to be likely.
  CHECK(found.rates.split == 0);
  CHECK(found.rates.merge == 0);
  CHECK(found.rates.connect == 0);
  CHECK(found.rates.disconnect == 0);
}

TEST_CASE("Births all over the frame make a flat map and a hot corner shows up", "[rates][slow]") {
  const bool corner = GENERATE(false, true);
  test::Scene scene;
  scene.frames = 400;
  const auto all = test::living(2.5, 0.2, scene.frames, scene.width, scene.height, 19);
  // The corner keeps all its births, the rest of the frame one in ten.
  core::Rng rng(20);
  for (const auto& stroke : all) {
    const Point p = stroke.at(stroke.length / 2);
    if (!corner || (p.x < 80 && p.y < 80) || rng.uniform() < 0.1) scene.strokes.push_back(stroke);
  }
  const auto motion = test::make(scene, 21).motion;
  const auto rates = mcmc::estimate_rates(mcmc::count_operators(motion, graph::stroke_events(motion))).rates;
  double in = 0, out = 0, inside = 0, outside = 0, least = 1e9, most = 0;
  for (int y = 8; y < scene.height; y += 16)
    for (int x = 8; x < scene.width; x += 16) {
      const double value = rates.birth.at({double(x), double(y)});
      (x < 80 && y < 80 ? in : out) += value;
      (x < 80 && y < 80 ? inside : outside) += 1;
      least = std::min(least, value), most = std::max(most, value);
    }
  const double ratio = (in / inside) / (out / outside);
  if (corner) {
    // Ten times as many, some of it smoothed over the border.
    CHECK(ratio > 5);
    CHECK(ratio < 13);
    CHECK(rates.birth.at({24, 24}) > 5 * rates.birth.at({200, 160}));
  } else {
    // 1000 births on 300 cells: a map of single cells would range from 0 to three times the mean.
    CHECK(ratio > 0.7);
    CHECK(ratio < 1.4);
    CHECK(most < 1.8 * births_a_frame(rates.birth) / (320 * 240.0));
    CHECK(least > 0.4 * births_a_frame(rates.birth) / (320 * 240.0));
  }
}

TEST_CASE("Deaths at one rate everywhere make a flat map, and more on one side show up", "[rates][slow]") {
  const bool uneven = GENERATE(false, true);
  test::Scene scene;
  scene.frames = 400;
  scene.strokes = test::living(2, 0.1, scene.frames, scene.width, scene.height, 22);
  if (uneven)  // on the left strokes live a fifth as long
    for (auto& stroke : scene.strokes)
      if (stroke.at(stroke.length / 2).x < 160)
        stroke.dies = stroke.born + 1 + (stroke.dies - stroke.born - 1) / 5;
  const auto motion = test::make(scene, 23).motion;
  const auto rates = mcmc::estimate_rates(mcmc::count_operators(motion, graph::stroke_events(motion))).rates;
  double left = 0, right = 0;
  for (double y = 8; y < 240; y += 16) left += rates.death.at({64, y}), right += rates.death.at({256, y});
  if (uneven)
    CHECK(left > 2.5 * right);
  else
    CHECK_THAT(left / right, Catch::Matchers::WithinAbs(1, 0.25));
}

TEST_CASE("Nothing happened: rates of zero and a note", "[rates]") {
  test::Frame frame;
  frame.line(test::segment({20, 40}, {120, 40}, 21));
  const auto found = mcmc::estimate_rates(counts_of(
      test::motion({frame.graph(), frame.graph(), frame.graph()}, {same(0, 0, 21), same(0, 0, 21)})));
  CHECK(found.notes.size() == 1);
  CHECK(births_a_frame(found.rates.birth) == 0);
  for (const auto& interval : found.events_per_frame) {
    CHECK(interval.low == 0);
    CHECK(interval.mean == 0);
    CHECK_THAT(interval.high, Catch::Matchers::WithinRel(1.92 / 2, 0.01));  // half of χ²'s quantile, 2 gaps
  }
  for (const double rate : found.rates.death_by_size) CHECK(rate == 0);
  CHECK(found.rates.split == 0);
  for (const double value : found.rates.death.values) CHECK(std::isfinite(value));
  for (const double value : found.rates.separation.values) CHECK(std::isfinite(value));
}

namespace {

int poisson(core::Rng& rng, double mean) {
  const double limit = std::exp(-mean);
  int n = 0;
  for (double product = rng.uniform(); product > limit; product *= rng.uniform()) ++n;
  return n;
}

// Probability below x of a Gamma law, by Simpson's rule over the logarithm.
double gamma_below(double x, double shape, double rate) {
  constexpr int steps = 200000;
  const double top = std::log(x * rate), width = 60 / shape + 20;
  double sum = 0;
  for (int i = 0; i <= steps; ++i) {
    const double v = top - width * i / steps;
    sum += (i == 0 || i == steps ? 1 : i % 2 ? 4 : 2) * std::exp(shape * v - std::exp(v));
  }
  return sum * width / steps / 3 / std::tgamma(shape);
}

mcmc::OperatorCounts blank(std::size_t gaps) {
  mcmc::OperatorCounts counts;
  counts.gaps = double(gaps);
  counts.expected_deaths = counts.expected_separations = mcmc::make_cell_grid(64, 48);
  counts.births.assign(gaps, counts.expected_deaths);
  counts.deaths = counts.separations = counts.births;
  return counts;
}

}  // namespace

TEST_CASE("A rate's interval leaves a twentieth of a Gamma law on either side", "[rates]") {
  for (const auto& [events, time, prior_events, prior_time] :
       {std::array{7.0, 100.0, 0.5, 0.0}, {0.0, 50.0, 0.2, 3.0}, {31.5, 99.0, 0.5, 0.0}}) {
    const auto found = mcmc::rate_interval(events, time, 0, prior_events, prior_time);
    const double shape = events + prior_events, rate = time + prior_time;
    CHECK_THAT(found.mean, Catch::Matchers::WithinRel(shape / rate, 1e-12));
    CHECK_THAT(gamma_below(found.low, shape, rate), Catch::Matchers::WithinAbs(0.05, 1e-4));
    CHECK_THAT(gamma_below(found.high, shape, rate), Catch::Matchers::WithinAbs(0.95, 1e-4));
  }
  CHECK_THROWS_AS(mcmc::rate_interval(0, 10, 0, 0, 0), core::InputError);
  CHECK_THROWS_AS(mcmc::rate_interval(1, 0, 0, 0, 0), core::InputError);
}

TEST_CASE("Intervals hold the true rate nine times in ten", "[rates][heavy]") {
  constexpr int trials = 4000;
  for (const double expected : {3.0, 10.0, 31.0, 120.0}) {
    core::Rng rng(31, {static_cast<std::uint32_t>(expected), 0, 0});
    int held = 0;
    for (int i = 0; i < trials; ++i) {
      auto counts = blank(99);
      counts.events[event(graph::EventType::merge)] = poisson(rng, expected);
      const auto interval = mcmc::estimate_rates(counts).events_per_frame[event(graph::EventType::merge)];
      held += interval.low <= expected / 99 && expected / 99 <= interval.high;
    }
    // Counts are whole numbers: the share swings about 0.9 as the mean changes, most where it is small.
    CAPTURE(expected, held / double(trials));
    CHECK_THAT(held / double(trials), Catch::Matchers::WithinAbs(0.9, expected < 5 ? 0.06 : 0.025));
  }
}

TEST_CASE("Intervals of deaths by size hold the true rates", "[rates]") {
  constexpr int trials = 2000;
  constexpr std::array<double, mcmc::kSizeClasses> true_rate{0.2, 0.1, 0.05, 0.03, 0.03, 0.02, 0.02},
      could{300, 400, 500, 600, 300, 200, 0};
  std::array<int, mcmc::kSizeClasses> held{};
  core::Rng rng(32);
  for (int i = 0; i < trials; ++i) {
    auto counts = blank(9);
    for (std::size_t s = 0; s < mcmc::kSizeClasses; ++s)
      counts.death[s] = {double(poisson(rng, true_rate[s] * could[s])), could[s]};
    const auto found = mcmc::estimate_rates(counts);
    for (std::size_t s = 0; s < mcmc::kSizeClasses; ++s) {
      const auto& interval = found.death_by_size[s];
      CHECK_THAT(interval.mean, Catch::Matchers::WithinRel(found.rates.death_by_size[s], 1e-9));
      held[s] += interval.low <= true_rate[s] && true_rate[s] <= interval.high;
    }
  }
  for (std::size_t s = 0; s < mcmc::kSizeClasses; ++s) {
    CAPTURE(s, held[s] / double(trials));
    if (could[s] > 0) CHECK_THAT(held[s] / double(trials), Catch::Matchers::WithinAbs(0.9, 0.07));
  }
  CHECK(held.back() == trials);  // nothing is known there, and the interval is wide
}
