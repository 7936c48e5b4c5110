// SPDX-License-Identifier: Apache-2.0
#include "mcmc/inference/change_posterior.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;
using mcmc::ChangeSeries;

namespace {

// The model as docs/method/events.md has it, once more.
constexpr double kSwitch = 0.02;

double density(double x, double mean, double variance) {
  return 0.95 * std::exp(-0.5 * (x - mean) * (x - mean) / variance) / std::sqrt(2 * M_PI * variance) +
         0.05 / 3;
}

/// What a frame says, in nats: there against not there.
double evidence(const ChangeSeries& s, std::size_t i) {
  const double variance = 0.0625 + 0.04 / (s.level * s.level), x = s.amplitude[i] / s.level;
  double nats = 0.7 * s.weight * std::log(density(x, 1, variance) / density(x, 0, variance));
  const bool there = (i >= s.at) == s.appears;
  return std::clamp(nats, -6.0, 6.0) * s.in_view[i] + (there ? 0.1 : -0.1);
}

/// Sums over all ways to be on and off: the odds of a change in the right sense within 2 frames.
double odds(const ChangeSeries& s, bool with_images) {
  const std::size_t count = s.amplitude.size();
  double with = 0, without = 0;
  for (std::uint32_t states = 0; states < (1U << count); ++states) {
    const auto on = [&](std::size_t i) { return (states >> i & 1U) != 0; };
    double weight = 1, changes = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (with_images && on(i)) weight *= std::exp(evidence(s, i));
      if (i == 0) continue;
      weight *= on(i) == on(i - 1) ? 1 - kSwitch : kSwitch;
      const bool near = i + 2 >= s.at && i <= s.at + 2;
      if (near && on(i) != on(i - 1) && on(i) == s.appears) changes += 1;
    }
    with += changes * weight, without += weight;
  }
  const double p = with / without;
  return p / (1 - p);
}

ChangeSeries random_series(std::uint64_t seed, std::size_t count) {
  core::Rng rng(seed);
  ChangeSeries series;
  series.at = 1 + rng.below(static_cast<std::uint32_t>(count - 1));
  series.appears = rng.below(2) == 0;
  series.level = rng.uniform(0.5, 1.5);
  series.weight = rng.uniform(0.1, 0.6);  // so that no probability is cut off at 0 or 1
  for (std::size_t i = 0; i < count; ++i) {
    series.amplitude.push_back(rng.uniform(-0.3, 1.6));
    series.in_view.push_back(rng.uniform() < 0.3 ? rng.uniform() : 1);
  }
  return series;
}

}  // namespace

TEST_CASE("The factor of a change is that of a sum over all ways to be on and off", "[change]") {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const ChangeSeries series = random_series(seed, 2 + seed % 9);
    INFO("seed " << seed);
    const double exact = std::clamp(std::log(odds(series, true) / odds(series, false)), -40 / 3.0, 40 / 3.0);
    CHECK_THAT(mcmc::log_change_factor(series), WithinAbs(exact, 1e-6));
  }
}

TEST_CASE("A change that shows is likelier than none, one that does not is less likely", "[change]") {
  ChangeSeries series;
  series.at = 10;
  for (int i = 0; i < 20; ++i) series.amplitude.push_back(i < 10 ? 0.05 : 0.95);
  CHECK(mcmc::log_change_factor(series) > 5);
  series.appears = false;  // it was read as going, but comes
  CHECK(mcmc::log_change_factor(series) < -3);
  std::ranges::reverse(series.amplitude);
  CHECK(mcmc::log_change_factor(series) > 5);
  std::ranges::fill(series.amplitude, 1.0);
  CHECK(mcmc::log_change_factor(series) < -3);
  std::ranges::fill(series.amplitude, 0.0);
  CHECK(mcmc::log_change_factor(series) < -3);
}

TEST_CASE("Time reversed, a change has the same factor", "[change]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    ChangeSeries series = random_series(seed, 12);
    const double forwards = mcmc::log_change_factor(series);
    std::ranges::reverse(series.amplitude);
    std::ranges::reverse(series.in_view);
    series.appears = !series.appears;
    series.at = 12 - series.at;
    CHECK_THAT(mcmc::log_change_factor(series), WithinAbs(forwards, 1e-9));
  }
}

TEST_CASE("Frames in which nothing of the change is in view tell nothing", "[change]") {
  ChangeSeries series;
  series.at = 6;
  for (int i = 0; i < 16; ++i) series.amplitude.push_back(i < 6 ? 1 : 0), series.in_view.push_back(i < 6);
  series.appears = false;
  CHECK(mcmc::log_change_factor(series) < 2);
  series.in_view.clear();
  CHECK(mcmc::log_change_factor(series) > 8);
  series.in_view.assign(15, 1);
  CHECK_THROWS_AS(mcmc::log_change_factor(series), core::InputError);
}

TEST_CASE("Each kind of evidence moves the odds of a change its own way", "[change]") {
  mcmc::ChangeEvidence usual;
  usual.log_factor = 5, usual.since = 5, usual.until = 8;
  for (const bool of_stroke : {true, false}) {
    usual.of_stroke = of_stroke;
    const double odds = mcmc::change_log_odds(usual);
    const auto with = [&](auto change) {
      mcmc::ChangeEvidence evidence = usual;
      change(evidence);
      return mcmc::change_log_odds(evidence);
    };
    CHECK(with([](auto& e) { e.log_factor = 10; }) > odds);
    CHECK(with([](auto& e) { e.since = 2; }) < odds);
    CHECK(with([](auto& e) { e.until = 2; }) < odds);
    CHECK(with([](auto& e) { e.until = 20; }) == odds);  // the shorter side counts
    CHECK(with([](auto& e) { e.contrast = 3; }) < odds - 1);
    CHECK(with([](auto& e) { e.contrast = 2; }) < with([](auto& e) { e.contrast = 3; }));
    CHECK(with([](auto& e) { e.contrast = 16; }) == odds);
    // Time has no sense here, and what is long enough ago does not count.
    CHECK(with([](auto& e) { std::swap(e.since, e.until); }) == odds);
    CHECK(with([](auto& e) { e.since = 12, e.until = 12; }) ==
          with([](auto& e) { e.since = 1e9, e.until = 1e9; }));
  }
}

TEST_CASE("Series that make no sense are refused", "[change]") {
  ChangeSeries series;
  series.amplitude = {0, 1, 1};
  series.at = 3;
  CHECK_THROWS_AS(mcmc::log_change_factor(series), core::InputError);
  series.at = 0;
  CHECK_THROWS_AS(mcmc::log_change_factor(series), core::InputError);
  series.at = 1, series.level = 0;
  CHECK_THROWS_AS(mcmc::log_change_factor(series), core::InputError);
  series.level = 1, series.amplitude[1] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(mcmc::log_change_factor(series), core::InputError);
}
