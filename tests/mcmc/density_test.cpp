// SPDX-License-Identifier: Apache-2.0
// The density's terms, one by one, against the formulas written out for hand-made states.
#include "mcmc/density.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "core/error.hpp"
#include "tests/catch.hpp"
#include "tests/mcmc/small_models.hpp"

using namespace emberfold;
using Catch::Matchers::WithinAbs;
using made::patch;
using made::shown;
using mcmc::Density;
using mcmc::HiddenGraph;
using mcmc::Index;
using mcmc::Theta;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTight = 1e-10;

double normal(double x, double sd) {
  return std::exp(-x * x / (2 * sd * sd)) / (std::sqrt(2 * kPi) * sd);
}
/// Density of a turn on either side, normal on (−π/2, π/2).
double turned(double x, double sd) {
  return normal(x, sd) / (2 * std::erf(kPi / 2 / std::sqrt(2.0) / sd));
}
/// One time in twenty the sketch errs, and what it shows spreads four times wider.
double erring(double (*density)(double, double), double x, double sd) {
  return 0.95 * density(x, sd) + 0.05 * density(x, 4 * sd);
}
double log_contrast(double contrast) {
  return std::log(1 + std::abs(contrast));
}
/// Variance of an AR(2) from its lag-one correlation: γ₀(1 − a₁ρ₁ − a₂ρ₂) = noise².
double stationary(const Theta& t) {
  const double rho1 = t.sway.a1 / (1 - t.sway.a2), rho2 = t.sway.a1 * rho1 + t.sway.a2;
  return t.sway.noise * t.sway.noise / (1 - t.sway.a1 * rho1 - t.sway.a2 * rho2);
}
double begun(const Theta& t, int frame, double contrast, std::size_t kind) {
  return t.birth[frame == 0 ? 0 : 1] / (2 * kPi) *
         normal(log_contrast(contrast) - t.new_contrast, t.new_contrast_sd) * t.kinds[kind];
}
/// Of what lies `along` and `side` of where it grows from, turned by `turn`, of the same kind and contrast.
double grown(const Theta& t, double along, double side, double turn) {
  const double line = 0.5 * (normal(along - t.step, t.step_sd) + normal(along + t.step, t.step_sd)) *
                      normal(side, t.side_sd) * turned(turn, t.bend_sd);
  const double r = t.branch_reach;
  const double anywhere = std::hypot(along, side) <= r ? 1 / (kPi * r * r) / (2 * kPi) : 0;
  return ((1 - t.branch) * line + t.branch * anywhere) * normal(0, t.grown_contrast_sd) * (1 - t.other_kind);
}
/// By the frame's area: that no stroke more begins.
double empty_frames(const Theta& t, double area, int frames) {
  return -t.birth[0] * area - (frames - 1) * t.birth[1] * area;
}
double chance(const Theta& t, std::size_t degree, std::size_t told, mcmc::Outcome what, bool can_merge,
              bool border = false) {
  const auto& row = t.outcome[mcmc::config(degree, border, told)];
  return row[static_cast<std::size_t>(what)] / (can_merge ? 1 : 1 - row[3]);
}

Theta theta() {
  auto t = made::even_theta();
  t.new_contrast = 3.1;
  return t;
}

}  // namespace

TEST_CASE("An empty state has the chance that nothing begins", "[mcmc][density]") {
  const HiddenGraph g(60, 40, 3, {12, 12, 0});
  CHECK_THAT(Density(theta()).total(g), WithinAbs(empty_frames(theta(), 2400, 3), kTight));
}

TEST_CASE("A stroke begins sways in its stationary law and dies", "[mcmc][density]") {
  const Theta t = theta();
  HiddenGraph g(60, 40, 2, {12, 12, 0});
  const Index v = shown(g, 0, patch(30, 20, 0.3, -25));
  g.set_sway(v, 0.7);
  g.set_place(v, 0.4, mcmc::kPlaces / 2, {});
  g.set_evidence(v, 3.5);
  const double expected = empty_frames(t, 2400, 2) + std::log(begun(t, 0, 25, 1)) + 0.4 - t.first_growth / 2 +
                          std::log(normal(0.7, std::sqrt(stationary(t)))) +
                          std::log(chance(t, 0, 0, mcmc::Outcome::death, false));
  CHECK_THAT(Density(t).total(g), WithinAbs(expected + 3.5, kTight));
  CHECK_THAT(Density(t, 0.25).total(g), WithinAbs(expected + 3.5 / 4, kTight));
  // In the last frame nobody asks what becomes of it.
  HiddenGraph late(60, 40, 2, {12, 12, 0});
  const Index w = shown(late, 1, patch(30, 20, 0.3, -25));
  late.set_sway(w, 0.7);
  CHECK_THAT(Density(t).total(late),
             WithinAbs(empty_frames(t, 2400, 2) + std::log(begun(t, 1, 25, 1)) - t.growth[3] / 2 +
                           std::log(normal(0.7, std::sqrt(stationary(t)))),
                       kTight));
}

TEST_CASE("The place on the death map scales a chance of death up to a limit", "[mcmc][density]") {
  const Theta t = theta();
  const double at_rest = t.outcome[0][0];
  for (std::size_t place = 0; place < mcmc::kPlaces; ++place) {
    HiddenGraph g(60, 40, 2, {12, 12, 0});
    const Index v = shown(g, 0, patch(30, 20));
    g.set_place(v, 0, static_cast<std::uint8_t>(place), {});
    const double death = std::min(0.95, at_rest * std::pow(2, (static_cast<double>(place) - 4) / 2));
    const double merge = t.outcome[0][3] * (1 - death) / (1 - at_rest);
    CHECK_THAT(Density(t).of_outcome(g, v), WithinAbs(std::log(death / (1 - merge)), kTight));
    // Going on takes its share of what is left.
    g.link(v, shown(g, 1, patch(30, 21)));
    const double going = t.outcome[0][1] * (1 - death) / (1 - at_rest);
    CHECK_THAT(Density(t).of_outcome(g, v), WithinAbs(std::log(going / (1 - merge)), kTight));
  }
}

TEST_CASE("What grows may have come in several ways", "[mcmc][density]") {
  const Theta t = theta();
  HiddenGraph g(60, 40, 1, {12, 12, 0});
  const Index a = shown(g, 0, patch(20, 20, 0.1)), b = shown(g, 0, patch(25, 21, 0.3));
  const Index c = shown(g, 0, patch(22, 25, 0.1));
  g.join(a, b), g.join(b, c);
  // In order a, b, c (by 0.8 x + 0.6 y): b may have grown from a, c from b but not from a.
  REQUIRE(g.before(a, b));
  REQUIRE(g.before(b, c));
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
  g.join(a, c);
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
  const Theta t = theta();
  HiddenGraph g(60, 40, 1, {12, 12, 0});
  const Index a = shown(g, 0, patch(20, 20, 0)), b = shown(g, 0, patch(25, 20, 0, -20));
  g.join(a, b);
  const double grows = t.first_growth * grown(t, 5, 0, 0) / (1 - t.other_kind) * t.other_kind / 2;
  CHECK_THAT(Density(t).of_arrival(g, b), WithinAbs(std::log(grows + begun(t, 0, 20, 1) * t.close[0][0]) +
                                                        std::log(normal(0, std::sqrt(stationary(t)))),
                                                    kTight));
}

TEST_CASE("A patch goes on where its sway and drift carry it", "[mcmc][density]") {
  const Theta t = theta();
  const auto& m = t.sway;
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
  // The third patch's direction is reversed: its sway is in the other sense.
  const Index w = shown(g, 2, at(third, direction + kPi + 0.25, 24));
  g.set_sway(u, 0.6), g.set_sway(v, 1.1), g.set_sway(w, -0.9);
  g.set_place(u, 0, 4, drift), g.set_place(v, 0, 4, drift * 2);
  g.link(u, v), g.link(v, w);
  const Density density(t);
  const double var = stationary(t), rho = m.a1 / (1 - m.a2);
  // Without a grandparent the sway goes on as its stationary law has it at lag one.
  CHECK_THAT(density.of_sway(g, v),
             WithinAbs(std::log(normal(1.1 - rho * 0.6, std::sqrt(var * (1 - rho * rho)))) +
                           std::log(normal(0.5 - (1.1 - 0.6), t.across)),
                       kTight));
  CHECK_THAT(density.of_arrival(g, v) - density.of_sway(g, v),
             WithinAbs(std::log(normal(0.8, t.along) * erring(turned, 0, t.turn) *
                                erring(normal, log_contrast(24) - log_contrast(20), t.flicker)),
                       kTight));
  const double mean = m.a1 * 1.1 + m.a2 * 0.6;
  CHECK_THAT(
      density.of_arrival(g, w),
      WithinAbs(std::log(normal(0.9 - mean, m.noise) * normal(0.9 - (0.9 - 1.1), t.across) *
                         normal(-0.3, t.along) * erring(turned, 0.25, t.turn) * erring(normal, 0, t.flicker)),
                kTight));
  // A neighbour of the one before draws it along, here one whose normal points to the other side.
  const Index x = shown(g, 1, at(second + along * 5, direction - kPi, 24));
  g.set_sway(x, 0.2);
  g.join(v, x);
  const double drawn = mean + m.coupling * (-0.2 - 1.1);
  CHECK_THAT(density.of_sway(g, w),
             WithinAbs(std::log(normal(0.9 - drawn, m.noise) * normal(0.9 - (0.9 - 1.1), t.across)), kTight));
}

TEST_CASE("A split has several heirs that spread wider", "[mcmc][density]") {
  const Theta t = theta();
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
                     std::pow(t.split_more, parts - 2) * factorial;
    CHECK(outcome(g, v) == mcmc::Outcome::split);
    CHECK_THAT(density.of_outcome(g, v), WithinAbs(std::log(p), kTight));
    const double lag = std::sqrt(stationary(t) * (1 - std::pow(t.sway.a1 / (1 - t.sway.a2), 2)));
    CHECK_THAT(
        density.of_arrival(g, heirs[0]),
        WithinAbs(std::log(normal(-1, t.along * t.split_spread) * normal(1, t.across * t.split_spread) *
                           normal(0, lag) * erring(turned, 0, t.turn) * erring(normal, 0, t.flicker)),
                  kTight));
  }
}

TEST_CASE("A patch merges into one that an earlier neighbour goes on as", "[mcmc][density]") {
  const Theta t = theta();
  const Density density(t);
  HiddenGraph g(80, 80, 2, {30, 12, 0});
  // In order u, v, x; u and v lie within 7 px of x, u and v of each other.
  const Index u = shown(g, 0, patch(40, 40)), v = shown(g, 0, patch(44, 40)), x = shown(g, 0, patch(46, 42));
  const Index w = shown(g, 1, patch(41, 40)), y = shown(g, 1, patch(44, 41));
  g.link(u, w);
  CHECK(mcmc::merge_targets(g, v) == 1);
  CHECK(mcmc::merge_targets(g, x) == 1);
  CHECK(mcmc::merge_targets(g, u) == 0);
  CHECK_THAT(density.of_outcome(g, v),
             WithinAbs(std::log(chance(t, 0, 0, mcmc::Outcome::death, true)), kTight));
  g.link(v, y);
  CHECK(mcmc::merge_targets(g, x) == 2);
  g.link(x, y);
  CHECK(mcmc::parent(g, y) == v);
  CHECK(outcome(g, v) == mcmc::Outcome::going_on);
  CHECK(outcome(g, x) == mcmc::Outcome::merge);
  CHECK_THAT(density.of_outcome(g, x),
             WithinAbs(std::log(chance(t, 0, 0, mcmc::Outcome::merge, true) / 2), kTight));
  CHECK_THAT(density.of_outcome(g, u),
             WithinAbs(std::log(chance(t, 0, 0, mcmc::Outcome::going_on, false)), kTight));
  // y comes from v alone.
  HiddenGraph without = g;
  without.unlink(x, y);
  CHECK(density.of_arrival(g, y) == density.of_arrival(without, y));
  // From too far away nothing merges.
  HiddenGraph far(80, 80, 2, {30, 20, 0});
  const Index a = shown(far, 0, patch(40, 40)), b = shown(far, 0, patch(48, 40));
  const Index c = shown(far, 1, patch(44, 40));
  far.link(a, c), far.link(b, c);
  CHECK(density.total(far) == -std::numeric_limits<double>::infinity());
}

TEST_CASE("A patch is told what became of its earlier neighbours", "[mcmc][density]") {
  const Theta t = theta();
  const Density density(t);
  HiddenGraph g(80, 80, 2, {7, 12, 0});
  made::row(g, 0, 3, 40, 40);
  const Index w = shown(g, 1, patch(40, 41));
  CHECK_THAT(density.of_outcome(g, 0),
             WithinAbs(std::log(chance(t, 1, 0, mcmc::Outcome::death, false)), kTight));
  CHECK_THAT(density.of_outcome(g, 1),
             WithinAbs(std::log(chance(t, 2, 2, mcmc::Outcome::death, false)), kTight));
  g.link(0, w);
  CHECK_THAT(density.of_outcome(g, 1),
             WithinAbs(std::log(chance(t, 2, 1, mcmc::Outcome::death, true)), kTight));
  CHECK_THAT(density.of_outcome(g, 2),
             WithinAbs(std::log(chance(t, 1, 2, mcmc::Outcome::death, false)), kTight));
  HiddenGraph edge(80, 80, 2, {7, 12, 0});
  shown(edge, 0, patch(72, 40));
  CHECK_THAT(density.of_outcome(edge, 0),
             WithinAbs(std::log(chance(t, 0, 0, mcmc::Outcome::death, false, true)), kTight));
}

TEST_CASE("Edges between patches that go on are kept or made", "[mcmc][density]") {
  const Theta t = theta();
  const Density density(t);
  HiddenGraph g(80, 80, 2, {12, 12, 0});
  made::row(g, 0, 3, 40, 40, false), made::row(g, 1, 3, 40, 40, false);
  for (Index i = 0; i < 3; ++i) g.link(i, i + 3);
  g.join(0, 1), g.join(3, 4);
  const auto of = [&](Index a, Index b) {
    const auto near = std::ranges::find(g.beside(a), b, &mcmc::Beside::node);
    return density.of_pair(g, a, *near);
  };
  CHECK_THAT(of(3, 4), WithinAbs(std::log(t.join[2][0]), kTight));
  CHECK_THAT(of(4, 5), WithinAbs(std::log(1 - t.join[0][0]), kTight));
  CHECK_THAT(of(3, 5), WithinAbs(std::log(1 - t.join[0][4]), kTight));
  g.join(1, 2);  // and 0 and 2 now have a neighbour in common
  CHECK_THAT(of(4, 5), WithinAbs(std::log(1 - t.join[2][0]), kTight));
  CHECK_THAT(of(3, 5), WithinAbs(std::log(1 - t.join[1][4]), kTight));
  g.cut(1, 2);
  g.cut(3, 4), g.join(3, 5);
  CHECK_THAT(of(3, 4), WithinAbs(std::log(1 - t.join[2][0]), kTight));
  CHECK_THAT(of(3, 5), WithinAbs(std::log(t.join[0][4]), kTight));
  // In a first frame, and with one that is new, pairs say nothing: those are closed, not kept.
  CHECK(of(0, 1) == 0);
  g.unlink(1, 4);
  CHECK(of(3, 4) == 0);
  // What one patch became is as good as joined.
  g.link(0, 4);
  CHECK(mcmc::were(g, 3, 4) == mcmc::Were::joined);
  CHECK_THAT(of(3, 4), WithinAbs(std::log(1 - t.join[2][0]), kTight));
}

TEST_CASE("A patch that goes on grows by the degree it had", "[mcmc][density]") {
  const Theta t = theta();
  const Density density(t);
  HiddenGraph g(80, 80, 2, {5.5, 12, 0});
  const Index v = shown(g, 0, patch(40, 40)), w = shown(g, 1, patch(40, 40));
  CHECK_THAT(density.of_presence(g, w), WithinAbs(-t.growth[3] / 2, kTight));
  g.link(v, w);
  const std::array<double, 4> by_degree = {t.growth[0], t.growth[0], t.growth[1], t.growth[2]};
  for (std::size_t degree = 0; degree < 4; ++degree) {
    CHECK_THAT(density.of_presence(g, w), WithinAbs(-by_degree[degree], kTight));
    const double a = 2 * static_cast<double>(degree);
    g.join(v, shown(g, 0, patch(40 + 5 * std::cos(a), 40 + 5 * std::sin(a))));
  }
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
    const auto report = check_ratios(g, Density(theta()), {made::checked(made::move_named("link, unlink"))});
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
  const auto report = check_ratios(g, density, {made::checked(made::move_named("link, unlink"))});
  CHECK(report.states == possible);
}

TEST_CASE("Theta's numbers out of range are named", "[mcmc][density]") {
  REQUIRE_NOTHROW(mcmc::validate(mcmc::usual_theta(300, 76800)));
  const auto refuse = [](auto change, const std::string& field) {
    auto t = mcmc::usual_theta(300, 76800);
    change(t);
    try {
      mcmc::validate(t);
      FAIL_CHECK(field << " was accepted");
    } catch (const core::InputError& error) {
      CHECK(std::string(error.what()).find(field) != std::string::npos);
    }
  };
  refuse([](Theta& t) { t.outcome[3][1] += 0.1; }, "outcome");
  refuse([](Theta& t) { t.outcome[3][1] = 0; }, "outcome");
  refuse([](Theta& t) { t.join[2][5] = 1; }, "join");
  refuse([](Theta& t) { t.join[0][0] = 0; }, "join");
  refuse([](Theta& t) { t.close[1][2] = -0.5; }, "close");
  refuse([](Theta& t) { t.split_more = 1; }, "split_more");
  refuse([](Theta& t) { t.branch = 0; }, "branch");
  refuse([](Theta& t) { t.other_kind = 0; }, "other_kind");
  refuse([](Theta& t) { t.kinds[2] = 0; }, "kinds");
  refuse([](Theta& t) { t.birth[0] = 0; }, "birth");
  refuse([](Theta& t) { t.growth[2] = std::nan(""); }, "growth");
  refuse([](Theta& t) { t.first_growth = -1; }, "first_growth");
  refuse([](Theta& t) { t.across = 0; }, "across");
  refuse([](Theta& t) { t.along = 0; }, "along");
  refuse([](Theta& t) { t.turn = 0; }, "turn");
  refuse([](Theta& t) { t.flicker = 0; }, "flicker");
  refuse([](Theta& t) { t.split_spread = 0; }, "split_spread");
  refuse([](Theta& t) { t.new_contrast_sd = 0; }, "new_contrast_sd");
  refuse([](Theta& t) { t.step = 0; }, "step");
  refuse([](Theta& t) { t.step_sd = 0; }, "step_sd");
  refuse([](Theta& t) { t.side_sd = 0; }, "side_sd");
  refuse([](Theta& t) { t.bend_sd = 0; }, "bend_sd");
  refuse([](Theta& t) { t.grown_contrast_sd = 0; }, "grown_contrast_sd");
  refuse([](Theta& t) { t.branch_reach = 0; }, "branch_reach");
  refuse([](Theta& t) { t.sway.noise = 0; }, "noise");
  refuse([](Theta& t) { t.sway.a1 = 2; }, "sway");
}
