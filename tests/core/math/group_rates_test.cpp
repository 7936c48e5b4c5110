// SPDX-License-Identifier: Apache-2.0
#include "core/math/group_rates.hpp"

#include <cmath>
#include <vector>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using core::CountedClip;

namespace {

double poisson(core::Rng& rng, double mean) {
  // Knuth's product of uniforms, for small means
  const double least = std::exp(-mean);
  double product = rng.uniform(), count = 0;
  for (; product > least; product *= rng.uniform()) ++count;
  return count;
}

/// Clips whose own rates spread about `mean` by the share `spread`, uniformly.
std::vector<CountedClip> drawn_group(core::Rng& rng, int clips, double mean, double spread) {
  std::vector<CountedClip> group;
  for (int i = 0; i < clips; ++i) {
    const double exposure = rng.uniform(5, 15);
    group.push_back({poisson(rng, exposure * mean * rng.uniform(1 - spread, 1 + spread)), exposure});
  }
  return group;
}

}  // namespace

TEST_CASE("the rate of one clip, and of clips that agree, is that of independent events") {
  const std::vector<CountedClip> one{{7, 20}}, alike{{7, 20}, {7, 20}, {7, 20}};
  const auto alone = core::event_rate(7, 20), of_one = core::group_rate(one).rate;
  CHECK(of_one.mean == alone.mean);
  CHECK(of_one.low == alone.low);
  CHECK(of_one.high == alone.high);
  const auto all = core::event_rate(21, 60), of_all = core::group_rate(alike).rate;
  CHECK(core::group_rate(alike).dispersion == 1);
  CHECK(of_all.low == Approx(all.low));
  CHECK(of_all.high == Approx(all.high));
}

TEST_CASE("intervals of groups hold the rate as often as they say, of clips that differ too") {
  core::Rng rng(3);
  for (const double spread : {0., 0.8}) {
    int held = 0, held_by_poisson = 0;
    const int draws = 1500;
    for (int i = 0; i < draws; ++i) {
      const auto group = drawn_group(rng, 6, 1.5, spread);
      const auto rate = core::group_rate(group).rate;
      held += rate.low <= 1.5 && 1.5 <= rate.high ? 1 : 0;
      double count = 0, exposure = 0;
      for (const auto& clip : group) count += clip.count, exposure += clip.exposure;
      const auto plain = core::event_rate(count, exposure);
      held_by_poisson += plain.low <= 1.5 && 1.5 <= plain.high ? 1 : 0;
    }
    INFO("spread " << spread << ": " << held << " and, of independent events, " << held_by_poisson);
    CHECK(held >= 0.87 * draws);
    CHECK(held <= 0.97 * draws);
    if (spread > 0) CHECK(held_by_poisson < 0.75 * draws);
  }
}

TEST_CASE("the test of two groups is an enumeration of how their clips could be dealt out") {
  // Of the twenty ways to choose three of these, only this one and its opposite lie so far apart.
  const std::vector<CountedClip> low{{1, 10}, {2, 10}, {3, 10}}, high{{11, 10}, {12, 10}, {13, 10}};
  const auto found = core::compare_groups(low, high);
  CHECK(found.permuted);
  CHECK(found.p == Approx(2. / 20));
  CHECK(found.ratio.mean == Approx(6));
  const auto opposite = core::compare_groups(high, low);
  CHECK(opposite.p == Approx(found.p));
  CHECK(opposite.ratio.low == Approx(1 / found.ratio.high));
  CHECK(opposite.ratio.high == Approx(1 / found.ratio.low));
  const auto pair = core::compare_groups(std::vector{low[0]}, std::vector{high[0]});
  CHECK_FALSE(pair.permuted);
  CHECK(pair.p == core::compare_rates(1, 10, 11, 10).p);
}

TEST_CASE("the test of two groups of one rate is significant as rarely as it says") {
  core::Rng rng(5);
  int exact = 0, drawn = 0, poisson_alone = 0;
  const int draws = 300;
  for (int i = 0; i < draws; ++i) {
    const auto a = drawn_group(rng, 5, 1, 0.8), b = drawn_group(rng, 5, 1, 0.8);
    exact += core::compare_groups(a, b).p <= 0.1 ? 1 : 0;
    double counts[2] = {}, exposures[2] = {};
    for (const auto& clip : a) counts[0] += clip.count, exposures[0] += clip.exposure;
    for (const auto& clip : b) counts[1] += clip.count, exposures[1] += clip.exposure;
    poisson_alone += core::compare_rates(counts[0], exposures[0], counts[1], exposures[1]).p <= 0.1 ? 1 : 0;
    if (i < 20) {
      const auto many = drawn_group(rng, 9, 1, 0.8), more = drawn_group(rng, 9, 1, 0.8);
      drawn += core::compare_groups(many, more, 0.9, 7).p <= 0.1 ? 1 : 0;
    }
  }
  INFO(exact << " and, of independent events, " << poisson_alone << " of " << draws << "; " << drawn
             << " of 20");
  CHECK(exact <= 0.15 * draws);
  CHECK(poisson_alone > exact);
  CHECK(drawn <= 6);
}

TEST_CASE("groups without clips, events or time") {
  const std::vector<CountedClip> none, empty{{0, 5}, {0, 7}}, some{{3, 5}, {4, 5}}, timeless{{1, 0}};
  CHECK_THROWS_AS(core::group_rate(none), core::InputError);
  CHECK_THROWS_AS(core::group_rate(timeless), core::InputError);
  CHECK(core::group_rate(empty).rate.low == 0);
  CHECK(core::group_rate(empty).rate.high > 0);
  CHECK(std::isinf(core::compare_groups(empty, some).ratio.high));
  CHECK(core::compare_groups(empty, empty).p == 1);
}
