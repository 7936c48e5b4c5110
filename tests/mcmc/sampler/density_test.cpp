// SPDX-License-Identifier: Apache-2.0
// The density's terms, one by one, against the formulas written out for hand-made states.
#include "mcmc/sampler/density.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/mcmc/formulas.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::formula;
using namespace emberfold::test;

TEST_CASE("An empty state has the chance that nothing begins", "[mcmc][density]") {
  const HiddenGraph g(60, 40, 3, {12, 12, 0});
  CHECK_THAT(Density(theta()).total(g), WithinAbs(empty_frames(theta(), 2400, 3), kTight));
}

TEST_CASE("A stroke begins sways in its stationary law and dies", "[mcmc][density]") {
  const SamplerParameters t = theta();
  HiddenGraph g(60, 40, 2, {12, 12, 0});
  const Index v = shown(g, 0, patch(30, 20, 0.3, -25));
  g.set_displacement(v, 0.7);
  g.set_map_values(v, 0.4, mcmc::kPlaces / 2, {});
  g.set_evidence(v, 3.5);
  const double expected = empty_frames(t, 2400, 2) + std::log(begun(t, 0, 25, 1)) + 0.4 - t.first_growth / 2 +
                          std::log(normal(0.7, std::sqrt(stationary(t)))) +
                          std::log(chance(t, 0, 0, mcmc::Outcome::death, false));
  CHECK_THAT(Density(t).total(g), WithinAbs(expected + 3.5, kTight));
  // In the last frame nobody asks what becomes of it.
  HiddenGraph late(60, 40, 2, {12, 12, 0});
  const Index w = shown(late, 1, patch(30, 20, 0.3, -25));
  late.set_displacement(w, 0.7);
  CHECK_THAT(Density(t).total(late),
             WithinAbs(empty_frames(t, 2400, 2) + std::log(begun(t, 1, 25, 1)) - t.growth[3] / 2 +
                           std::log(normal(0.7, std::sqrt(stationary(t)))),
                       kTight));
}

TEST_CASE("What grows may have come in several ways", "[mcmc][density]") {
  const SamplerParameters t = theta();
  HiddenGraph g(60, 40, 1, {12, 12, 0});
  const Index a = shown(g, 0, patch(20, 20, 0.1)), b = shown(g, 0, patch(25, 21, 0.3));
  const Index c = shown(g, 0, patch(22, 25, 0.1));
  g.add_edge(a, b), g.add_edge(b, c);
  // In order a, b, c (by 0.8 x + 0.6 y): b may have grown from a, c from b but not from a.
  REQUIRE(g.precedes(a, b));
  REQUIRE(g.precedes(b, c));
  const auto lies = [](double dx, double dy, double direction) {
    return std::pair{dx * std::cos(direction) + dy * std::sin(direction),
                     -dx * std::sin(direction) + dy * std::cos(direction)};
  };
  const auto [ab_along, ab_side] = lies(5, 1, 0.1);
  const auto [bc_along, bc_side] = lies(-3, 4, 0.3);
  // Between a and b 5.1 px in line; b and c 5 px, a and c 5.4 px, both across: closeness 0, 1, 1.
  const double from_a =
      t.first_growth * grown(t, ab_along, ab_side, 0.2) + begun(t, 0, 20, 0) * t.close[0][0];
  const double from_b =
      t.first_growth * grown(t, bc_along, bc_side, 0.2) + begun(t, 0, 20, 0) * t.close[0][1];
  const double expected = -t.birth[0] * 2400 - 3 * t.first_growth / 2 + std::log(begun(t, 0, 20, 0)) +
                          std::log(from_a) + std::log(from_b) + std::log(1 - t.close[0][1]) +
                          3 * std::log(normal(0, std::sqrt(stationary(t))));
  CHECK_THAT(Density(t).total(g), WithinAbs(expected, kTight));

  // With all three joined, c may have grown from either and the other edge closed.
  g.add_edge(a, c);
  const auto [ac_along, ac_side] = lies(2, 5, 0.1);
  const double close = t.close[0][1];
  const double from_both =
      t.first_growth * close * (grown(t, ac_along, ac_side, 0) + grown(t, bc_along, bc_side, 0.2)) +
      begun(t, 0, 20, 0) * close * close;
  CHECK_THAT(Density(t).total(g),
             WithinAbs(expected - std::log(from_b) - std::log(1 - close) + std::log(from_both), kTight));
  const auto origins = Density(t).origins(g, c);
  REQUIRE(origins.from.size() == 2);
  CHECK_THAT(origins.begun, WithinAbs(begun(t, 0, 20, 0) * close * close / from_both, 1e-12));
  CHECK_THAT(origins.shares[origins.from.find(a)],
             WithinAbs(t.first_growth * close * grown(t, ac_along, ac_side, 0) / from_both, 1e-12));
  CHECK_THAT(origins.begun + origins.shares[0] + origins.shares[1], WithinAbs(1, 1e-12));
}

TEST_CASE("A patch of another kind grows seldom", "[mcmc][density]") {
  const SamplerParameters t = theta();
  HiddenGraph g(60, 40, 1, {12, 12, 0});
  const Index a = shown(g, 0, patch(20, 20, 0)), b = shown(g, 0, patch(25, 20, 0, -20));
  g.add_edge(a, b);
  const double grows = t.first_growth * grown(t, 5, 0, 0) / (1 - t.other_kind) * t.other_kind / 2;
  CHECK_THAT(Density(t).log_birth_or_survival(g, b),
             WithinAbs(std::log(grows + begun(t, 0, 20, 1) * t.close[0][0]) +
                           std::log(normal(0, std::sqrt(stationary(t)))),
                       kTight));
}

TEST_CASE("A patch goes on where its sway and drift carry it", "[mcmc][density]") {
  const SamplerParameters t = theta();
  const auto& m = t.displacement;
  HiddenGraph g(80, 80, 3, {12, 12, 0});
  const double direction = 0.3;
  const graph::Point along{std::cos(direction), std::sin(direction)}, across{-along.y, along.x};
  const graph::Point drift{0.4, -0.2};
  const auto at = [&](graph::Point p, double theta, double contrast) {
    auto result = patch(p.x, p.y, theta, contrast);
    return result;
  };
  const graph::Point first{40, 40}, second = first + drift + along * 0.8 + across * 0.5;
  const graph::Point third = second + drift * 2 + along * -0.3 + across * 0.9;
  const Index u = shown(g, 0, at(first, direction, 20)), v = shown(g, 1, at(second, direction, 24));
  // The third patch's direction is reversed: its displacement is in the other sense.
  const Index w = shown(g, 2, at(third, direction + std::numbers::pi + 0.25, 24));
  g.set_displacement(u, 0.6), g.set_displacement(v, 1.1), g.set_displacement(w, -0.9);
  g.set_map_values(u, 0, 4, drift), g.set_map_values(v, 0, 4, drift * 2);
  g.link(u, v), g.link(v, w);
  const Density density(t);
  const double var = stationary(t), rho = m.a1 / (1 - m.a2);
  // Without a grandparent the displacement follows its stationary law at lag one.
  CHECK_THAT(density.log_displacement(g, v),
             WithinAbs(std::log(normal(1.1 - rho * 0.6, std::sqrt(var * (1 - rho * rho)))) +
                           std::log(normal(0.5 - (1.1 - 0.6), t.across)),
                       kTight));
  CHECK_THAT(density.log_birth_or_survival(g, v) - density.log_displacement(g, v),
             WithinAbs(std::log(normal(0.8, t.along) * erring(turned, 0, t.turn) *
                                erring(normal, log_contrast(24) - log_contrast(20), t.flicker)),
                       kTight));
  const double mean = m.a1 * 1.1 + m.a2 * 0.6;
  CHECK_THAT(
      density.log_birth_or_survival(g, w),
      WithinAbs(std::log(normal(0.9 - mean, m.noise) * normal(0.9 - (0.9 - 1.1), t.across) *
                         normal(-0.3, t.along) * erring(turned, 0.25, t.turn) * erring(normal, 0, t.flicker)),
                kTight));
  // A neighbour of the one before draws it along, here one whose normal points to the other side.
  const Index x = shown(g, 1, at(second + along * 5, direction - std::numbers::pi, 24));
  g.set_displacement(x, 0.2);
  g.add_edge(v, x);
  const double drawn = mean + m.coupling * (-0.2 - 1.1);
  CHECK_THAT(density.log_displacement(g, w),
             WithinAbs(std::log(normal(0.9 - drawn, m.noise) * normal(0.9 - (0.9 - 1.1), t.across)), kTight));
}

TEST_CASE("Edges between patches that go on are kept or made", "[mcmc][density]") {
  const SamplerParameters t = theta();
  const Density density(t);
  HiddenGraph g(80, 80, 2, {12, 12, 0});
  test::row(g, 0, 3, 40, 40, false), test::row(g, 1, 3, 40, 40, false);
  for (Index i = 0; i < 3; ++i) g.link(i, i + 3);
  g.add_edge(0, 1), g.add_edge(3, 4);
  const auto of = [&](Index a, Index b) {
    const auto near = std::ranges::find(g.neighbours(a), b, &mcmc::NeighbourCandidate::node);
    return density.log_edge(g, a, *near);
  };
  CHECK_THAT(of(3, 4), WithinAbs(std::log(t.join[2][0]), kTight));
  CHECK_THAT(of(4, 5), WithinAbs(std::log(1 - t.join[0][0]), kTight));
  CHECK_THAT(of(3, 5), WithinAbs(std::log(1 - t.join[0][4]), kTight));
  g.add_edge(1, 2);  // and 0 and 2 now have a neighbour in common
  CHECK_THAT(of(4, 5), WithinAbs(std::log(1 - t.join[2][0]), kTight));
  CHECK_THAT(of(3, 5), WithinAbs(std::log(1 - t.join[1][4]), kTight));
  g.remove_edge(1, 2);
  g.remove_edge(3, 4), g.add_edge(3, 5);
  CHECK_THAT(of(3, 4), WithinAbs(std::log(1 - t.join[2][0]), kTight));
  CHECK_THAT(of(3, 5), WithinAbs(std::log(t.join[0][4]), kTight));
  // Pairs of a first frame, or with a new patch, have no edge factor: they are closed, not kept.
  CHECK(of(0, 1) == 0);
  g.unlink(1, 4);
  CHECK(of(3, 4) == 0);
  // Patches that continue one patch count as joined.
  g.link(0, 4);
  CHECK(mcmc::previous_adjacency(g, 3, 4) == mcmc::PreviousAdjacency::joined);
  CHECK_THAT(of(3, 4), WithinAbs(std::log(1 - t.join[2][0]), kTight));
}

TEST_CASE("A patch that goes on grows by the degree it had", "[mcmc][density]") {
  const SamplerParameters t = theta();
  const Density density(t);
  HiddenGraph g(80, 80, 2, {5.5, 12, 0});
  const Index v = shown(g, 0, patch(40, 40)), w = shown(g, 1, patch(40, 40));
  CHECK_THAT(density.log_presence(g, w), WithinAbs(-t.growth[3] / 2, kTight));
  g.link(v, w);
  const std::array<double, 4> by_degree = {t.growth[0], t.growth[0], t.growth[1], t.growth[2]};
  for (std::size_t degree = 0; degree < 4; ++degree) {
    CHECK_THAT(density.log_presence(g, w), WithinAbs(-by_degree[degree], kTight));
    const double a = 2 * static_cast<double>(degree);
    g.add_edge(v, shown(g, 0, patch(40 + 5 * std::cos(a), 40 + 5 * std::sin(a))));
  }
}
