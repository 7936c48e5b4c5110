// SPDX-License-Identifier: Apache-2.0
#include "mcmc/simulation/simulated_strokes.hpp"

#include <numbers>

#include "tests/support/catch.hpp"
#include "tests/support/motion_models.hpp"
#include "tests/support/motion_scene.hpp"

using namespace emberfold;
using graph::Point;
using mcmc::detail::Purpose;
using mcmc::detail::SimulatedPatch;
using mcmc::detail::SimulatedStrokes;

namespace {

// Strokes through the given places.
SimulatedStrokes particles(const std::vector<std::vector<Point>>& strokes) {
  SimulatedStrokes result;
  for (const auto& points : strokes)
    for (std::size_t k = 0; k < points.size(); ++k) {
      SimulatedPatch particle;
      particle.rest = test::vertex(0, points[k].x, points[k].y).patch;
      const auto index = result.add(particle);
      if (k > 0) result.edges.emplace_back(index - 1, index);
    }
  return result;
}

// A law without memory: the displacement is the noise itself.
mcmc::MotionModel noise_alone(double range, double gain_range) {
  auto model = test::empty_model();
  model.displacement = {0, 0, 0, 1, range, 0};
  model.contrast = {0, 0, 0, 1, gain_range, 0};
  return model;
}

// Mean of what `product` makes of each of n draws, and five times its SD where it is the product of two
// standard normals that correlate by r.
template <class Product>
double mean(int n, Product product) {
  double sum = 0;
  for (int i = 0; i < n; ++i) sum += product(i);
  return sum / n;
}
double five_sigma(double r, int n) {
  return 5 * std::sqrt((1 + r * r) / n);
}

}  // namespace

TEST_CASE("The noise has variance 1 and correlates along a stroke as it should", "[particles]") {
  const double range = GENERATE(5.0, 20.0);
  const auto model = noise_alone(range, range);
  // Not on the lattice of anything, far and near, and below zero.
  const Point at = GENERATE(Point{0, 0}, Point{131.7, 57.3}, Point{-9.1, 300.2});
  const double h1 = 0.5 * range, h2 = 1.5 * range;
  const Point along = {std::cos(0.7), std::sin(0.7)};
  auto p = particles({{at, at + along * h1, at + along * h2}});
  constexpr int n = 8000;
  std::vector<std::array<std::array<double, 3>, 3>> draws;  // x, y, gain of three patches
  for (int step = 0; step < n; ++step) {
    step_motion(p, model, 42, Purpose::motion, static_cast<std::uint32_t>(step));
    draws.emplace_back();
    for (std::size_t i = 0; i < 3; ++i)
      draws.back()[i] = {p.list[i].offset.x, p.list[i].offset.y, p.list[i].gain};
  }
  const auto correlation = [&](std::size_t i, std::size_t c, std::size_t j, std::size_t d, int lag) {
    return mean(n - lag, [&](int t) {
      return draws[static_cast<std::size_t>(t)][i][c] *
             draws[static_cast<std::size_t>(t) + static_cast<std::size_t>(lag)][j][d];
    });
  };
  const auto should = [&](double h) { return std::exp(-h * h / (2 * range * range)); };
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK_THAT(mean(n, [&](int t) { return draws[static_cast<std::size_t>(t)][0][c]; }),
               Catch::Matchers::WithinAbs(0, 5 / std::sqrt(double(n))));
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK_THAT(correlation(i, c, i, c, 0), Catch::Matchers::WithinAbs(1, five_sigma(1, n)));
      CHECK_THAT(correlation(i, c, i, c, 1), Catch::Matchers::WithinAbs(0, five_sigma(0, n)));
      CHECK_THAT(correlation(i, c, i, (c + 1) % 3, 0), Catch::Matchers::WithinAbs(0, five_sigma(0, n)));
    }
    for (const auto& [i, j, h] : {std::tuple{0, 1, h1}, {0, 2, h2}, {1, 2, h2 - h1}})
      CHECK_THAT(correlation(std::size_t(i), c, std::size_t(j), c, 0),
                 Catch::Matchers::WithinAbs(should(h), five_sigma(should(h), n)));
  }
}

TEST_CASE("Noise without a range is each patch's own and sway and contrast know nothing of each other",
          "[particles]") {
  const auto [range, gain_range] = GENERATE(std::pair{0.0, 0.0}, std::pair{20.0, 0.0}, std::pair{0.0, 20.0});
  auto p = particles({{{0, 0}, {5, 0}}});
  constexpr int n = 8000;
  double between = 0, own = 0, crossed = 0, power = 0;
  for (int step = 0; step < n; ++step) {
    step_motion(p, noise_alone(range, gain_range), 43, Purpose::motion, static_cast<std::uint32_t>(step));
    const auto &a = p.list[0], &b = p.list[1];
    between += (range > 0 ? a.gain * b.gain : a.offset.x * b.offset.x) / n;
    own += a.offset.x * a.gain / n, crossed += a.offset.y * a.gain / n, power += a.gain * a.gain / n;
  }
  CHECK_THAT(power, Catch::Matchers::WithinAbs(1, five_sigma(1, n)));
  CHECK_THAT(between, Catch::Matchers::WithinAbs(0, five_sigma(0, n)));
  CHECK_THAT(own, Catch::Matchers::WithinAbs(0, five_sigma(0, n)));
  CHECK_THAT(crossed, Catch::Matchers::WithinAbs(0, five_sigma(0, n)));
}

TEST_CASE("Strokes near each other sway alike and far apart on their own and so do seeds and purposes",
          "[particles]") {
  const auto model = noise_alone(20, 20);
  auto p = particles({{{50, 50}, {55, 50}}, {{50, 70}, {55, 70}}, {{250, 50}, {255, 50}}}), other = p,
       start = p;
  constexpr int n = 8000;
  double near = 0, far = 0, seeds = 0, purposes = 0;
  for (int step = 0; step < n; ++step) {
    const auto number = static_cast<std::uint32_t>(step);
    step_motion(p, model, 1, Purpose::motion, number);
    step_motion(other, model, 2, Purpose::motion, number);
    step_motion(start, model, 1, Purpose::start, number);
    near += p.list[0].offset.x * p.list[2].offset.x / n;
    far += p.list[0].offset.x * p.list[4].offset.x / n;
    seeds += p.list[0].offset.x * other.list[0].offset.x / n;
    purposes += p.list[0].offset.x * start.list[0].offset.x / n;
  }
  CHECK_THAT(near, Catch::Matchers::WithinAbs(std::exp(-0.5), five_sigma(0.5, n)));
  CHECK_THAT(far, Catch::Matchers::WithinAbs(0, five_sigma(0, n)));
  CHECK_THAT(seeds, Catch::Matchers::WithinAbs(0, five_sigma(0, n)));
  CHECK_THAT(purposes, Catch::Matchers::WithinAbs(0, five_sigma(0, n)));
}

TEST_CASE("Particles are settled in the stationary state and stay in it", "[particles][heavy]") {
  const test::Law law =
      GENERATE(test::Law{1.6, -0.7, 0.3, 15}, test::Law{0.9, 0, 0.5, 0}, test::Law{0.2, -0.5, 2, 40});
  auto model = test::empty_model();
  model.displacement = {law.a1, law.a2, 0, law.noise, law.range, 0};
  model.contrast = {0.5, 0.2, 0, 0.1, law.range, 0};
  std::vector<std::vector<Point>> strokes;
  for (int i = 0; i < 6000; ++i) {  // so far from each other that they know nothing of each other
    const int column = i % 80, row = i / 80;
    const Point at{250.0 * column, 250.0 * row};
    strokes.push_back({at, at + Point{5, 0}});
  }
  auto p = particles(strokes);
  draw_stationary_motion(p, model, 7);
  const auto check = [&] {
    double now = 0, before = 0, both = 0, gain = 0;
    for (std::size_t i = 0; i < p.list.size(); i += 2) {  // of each stroke one
      const auto& it = p.list[i];
      now += it.offset.x * it.offset.x / 6000, before += it.offset_before.y * it.offset_before.y / 6000;
      both += it.offset.x * it.offset_before.x / 6000, gain += it.gain * it.gain / 6000;
    }
    const double variance = law.deviation() * law.deviation(), r = law.a1 / (1 - law.a2);
    CHECK_THAT(now, Catch::Matchers::WithinRel(variance, five_sigma(1, 6000)));
    CHECK_THAT(before, Catch::Matchers::WithinRel(variance, five_sigma(1, 6000)));
    CHECK_THAT(both / variance, Catch::Matchers::WithinAbs(r, five_sigma(r, 6000)));
    const double gains = test::Law{0.5, 0.2, 0.1, 0}.deviation();
    CHECK_THAT(gain, Catch::Matchers::WithinRel(gains * gains, five_sigma(1, 6000)));
  };
  check();
  for (std::uint32_t step = 0; step < 25; ++step) step_motion(p, model, 7, Purpose::motion, step);
  check();
}

TEST_CASE("What appears beside others sways as they do", "[particles]") {
  auto model = test::empty_model(2000, 2000);
  model.displacement = {1.6, -0.7, 0, 0.3, 20, 0};
  model.contrast = {0.5, 0.2, 0, 0.1, 20, 0};
  const double variance = std::pow(stationary_deviation(model.displacement), 2);
  constexpr int n = 3000;
  double at_once = 0, near = 0, far = 0, power = 0;
  for (int i = 0; i < n; ++i) {
    auto p = particles({{{500, 500}}});
    const auto seed = static_cast<std::uint64_t>(i);
    draw_stationary_motion(p, model, seed);
    for (const Point place : {Point{500, 500}, {500, 520}, {900, 900}}) {
      auto both = p;
      add_stationary(both, test::straight(1), place, 0, model, seed);
      const auto &old = both.list[0], &fresh = both.list[1];
      if (place.x > 600) {
        far += old.offset.x * fresh.offset.x / n;
      } else if (place.y > 510) {
        near += old.offset.x * fresh.offset.x / n, power += fresh.offset.x * fresh.offset.x / n;
      } else {
        at_once += std::abs(old.offset.x - fresh.offset.x) + std::abs(old.gain_before - fresh.gain_before);
      }
    }
  }
  CHECK_THAT(at_once, Catch::Matchers::WithinAbs(0, 1e-9));
  CHECK_THAT(near / variance, Catch::Matchers::WithinAbs(std::exp(-0.5), five_sigma(0.5, n)));
  CHECK_THAT(power / variance, Catch::Matchers::WithinAbs(1, five_sigma(1, n)));
  CHECK_THAT(far / variance, Catch::Matchers::WithinAbs(0, five_sigma(0, n)));
}

TEST_CASE("A motion without noise decays as its law says, each coordinate and the contrast", "[particles]") {
  auto model = test::empty_model();
  model.displacement = {1.2, -0.4, 0.25, 0, 0, 0};
  model.contrast = {0.5, 0.1, 0, 0, 0, 0};
  auto p = particles({{{0, 0}, {5, 0}, {10, 0}}});
  p.list[0].offset = {1, 0}, p.list[1].offset = {0, 2}, p.list[1].offset_before = {4, 0};
  p.list[2].gain = 1, p.list[2].gain_before = 2;
  step_motion(p, model, 1, Purpose::motion, 1);
  // 0: 1.2·(1, 0) + 0.25·((0, 2) − (1, 0)); 1: 1.2·(0, 2) − 0.4·(4, 0) + 0.25·((0.5, 0) − (0, 2)).
  CHECK_THAT(p.list[0].offset.x, Catch::Matchers::WithinAbs(0.95, 1e-12));
  CHECK_THAT(p.list[0].offset.y, Catch::Matchers::WithinAbs(0.5, 1e-12));
  CHECK_THAT(p.list[1].offset.x, Catch::Matchers::WithinAbs(-1.475, 1e-12));
  CHECK_THAT(p.list[1].offset.y, Catch::Matchers::WithinAbs(1.9, 1e-12));
  CHECK_THAT(p.list[2].gain, Catch::Matchers::WithinAbs(0.7, 1e-12));
  CHECK(p.list[1].offset_before == Point{0, 2});
}

TEST_CASE("A patch brought to some of its contrast keeps its surroundings", "[particles]") {
  auto model = test::empty_model();
  model.appearing = {0.25, 0.5, 1, 1, 1, 1, 1, 1};
  model.vanishing = {0.1, 0.75, 1, 1, 1, 1, 1, 1};
  auto p = particles({{{50, 50}, {55, 50}, {60, 50}}});
  for (auto& particle : p.list) particle.age = 100;
  auto& line = p.list[0].rest;
  line.left = {100, 110, 120}, line.right = {80, 90, 100}, line.middle = {130, 140, 150};
  auto& step = p.list[1].rest;
  step.width = 0, step.type = graph::PatchType::step;
  step.left = {10, 20, 30}, step.right = {110, 100, 90}, step.middle = {60, 60, 60}, step.contrast = 80;
  const auto shown = [&](std::size_t i) { return drawn_graph(p, model).patch(i); };
  const auto full_line = shown(0), full_step = shown(1);
  CHECK(full_line.left == line.left);
  CHECK(full_line.middle == line.middle);
  CHECK(full_step.left == step.left);
  const auto check = [&](double share) {
    const auto a = shown(0), b = shown(1);
    CHECK_THAT(a.contrast, Catch::Matchers::WithinRel(line.contrast * share, 1e-9));
    CHECK_THAT(b.contrast, Catch::Matchers::WithinRel(80 * share, 1e-9));
    // A line's sides stay, its core comes towards their mean; a step's sides come towards each other.
    CHECK(a.left == line.left);
    CHECK(a.right == line.right);
    CHECK_THAT(double(a.middle[0]), Catch::Matchers::WithinAbs(90 + share * 40, 1e-4));
    CHECK_THAT(double(a.middle[2]), Catch::Matchers::WithinAbs(110 + share * 40, 1e-4));
    CHECK_THAT(double(b.left[0]), Catch::Matchers::WithinAbs(60 - share * 50, 1e-4));
    CHECK_THAT(double(b.right[0]), Catch::Matchers::WithinAbs(60 + share * 50, 1e-4));
    CHECK_THAT(double(b.right[2]), Catch::Matchers::WithinAbs(60 + share * 30, 1e-4));
  };
  for (const double gain : {-0.7, 0.2}) {
    for (auto& particle : p.list) particle.gain = gain;
    check(std::exp(gain));
  }
  for (auto& particle : p.list) particle.gain = 0;
  for (const auto& [age, leaving, share] : {std::tuple{0, -1, 0.25},
                                            {1, -1, 0.5},
                                            {2, -1, 1.0},
                                            {50, 0, 0.1},
                                            {50, 1, 0.75},
                                            {50, 7, 1.0},
                                            {50, 100, 1.0},
                                            {0, 0, 0.1},
                                            {0, 1, 0.25}}) {
    for (auto& particle : p.list) particle.age = age, particle.frames_left = leaving;
    check(share);
  }
}

TEST_CASE("Directions turn with the stroke and types follow from degrees", "[particles]") {
  auto p = particles({{{50, 50}, {55, 50}, {60, 50}, {65, 50}}, {{55, 60}}});
  for (std::size_t i = 0; i < 4; ++i) {
    // The stroke turns by 30 degrees about its first patch.
    const double s = 5 * double(i), angle = std::numbers::pi / 6;
    p.list[i].offset = Point{std::cos(angle), std::sin(angle)} * s - Point{s, 0};
  }
  auto graph = mcmc::detail::stroke_graph(p);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK_THAT(graph.patch(i).theta, Catch::Matchers::WithinAbs(std::numbers::pi / 6, 1e-12));
    CHECK(graph.patch(i).position == p.list[i].position());
    CHECK(graph.patch(i).type == (i % 3 == 0 ? graph::PatchType::terminator : graph::PatchType::ridge));
  }
  CHECK(graph.patch(4).theta == 0);
  p.edges.emplace_back(1, 4);
  graph = mcmc::detail::stroke_graph(p);
  CHECK(graph.patch(1).type == graph::PatchType::y_junction);
  CHECK(graph.patch(4).type == graph::PatchType::terminator);
}

TEST_CASE("What is removed takes its edges along and leaves the others", "[particles]") {
  auto p = particles({{{0, 0}, {5, 0}, {10, 0}, {15, 0}, {20, 0}}});
  mcmc::detail::remove_patches(p, {true, false, false, true, false});
  CHECK(p.ids == std::vector<std::uint32_t>{1, 2, 4});
  REQUIRE(p.edges.size() == 1);
  CHECK(p.edges[0] == std::pair{0U, 1U});
  CHECK(p.list[2].rest.position == Point{20, 0});
  p.add(SimulatedPatch{});
  CHECK(p.ids.back() == 5);
}

TEST_CASE("A place's share of the sway scales what is seen of it", "[particles]") {
  auto model = test::empty_model();
  model.displacement = {0.5, 0, 0, 1, 15, 0};
  for (std::size_t c = 0; c < model.displacement_scale.values.size(); ++c)
    model.displacement_scale.values[c] = c % std::size_t(model.displacement_scale.columns) < 10 ? 0.0 : 2.0;
  SimulatedStrokes p;
  add_stationary(p, test::straight(5), {40, 100}, 3, model, 1);
  add_stationary(p, test::straight(5), {280, 100}, 3, model, 1);
  REQUIRE(p.list.size() == 10);
  for (std::size_t i = 0; i < 10; ++i) {
    const Point off = p.list[i].position() - p.list[i].rest.position;
    CHECK(graph::norm(off - p.list[i].offset * (i < 5 ? 0 : 2)) < 1e-12);
    CHECK(p.list[i].age == 3);
  }
}

TEST_CASE("A stroke begins in the shape that was seen, and bends smoothly from there", "[particles]") {
  auto model = test::empty_model();
  model.displacement = {0.9, 0, 0, 1, 40, 0};
  // The sway of neighbouring cells differs by a factor of 20, as it does where few tracks tell of it.
  for (std::size_t c = 0; c < model.displacement_scale.values.size(); ++c)
    model.displacement_scale.values[c] = c % 2 == 0 ? 0.2 : 4.0;
  SimulatedStrokes p;
  add_stationary(p, test::straight(30), {160, 100}, 0, model, 1);
  const auto seen = test::straight(30);
  for (std::size_t i = 0; i < 30; ++i)
    CHECK(graph::distance(p.list[i].position(), seen.patch(std::uint32_t(i)).position + Point{160, 100}) <
          1e-9);
  // Beside it, at other distances from its patches.
  add_stationary(p, test::straight(30, 0.3), {160, 110}, 0, model, 2);
  for (std::uint32_t step = 0; step < 20; ++step) step_motion(p, model, 7, Purpose::motion, step);
  double moved = 0;
  for (std::size_t i = 0; i < 60; ++i) {
    const auto& me = p.list[i];
    moved = std::max(moved, graph::distance(me.position(), me.rest.position));
    if (i % 30 == 0) continue;
    const Point chord = me.position() - p.list[i - 1].position();
    CHECK(std::abs(graph::norm(chord) - 5) < 2.5);
  }
  CHECK(moved > 2);
}
