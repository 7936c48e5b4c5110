// SPDX-License-Identifier: Apache-2.0
#include "core/math/event_rates.hpp"

#include <cmath>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

/// A Poisson number by Knuth's product of uniforms.
double poisson(double mean, core::Rng& rng) {
  double product = rng.uniform(), count = 0;
  for (const double end = std::exp(-mean); product > end; ++count) product *= rng.uniform();
  return count;
}

}  // namespace

TEST_CASE("intervals of rates are those of the tables") {
  // Garwood 1936, as in scipy.stats.chi2.ppf([.05, .95], [2 k, 2 k + 2]) / 2
  const auto none = core::event_rate(0, 2);
  CHECK(none.mean == 0);
  CHECK(none.low == 0);
  CHECK(none.high == Approx(2.995732 / 2).epsilon(1e-6));
  const auto ten = core::event_rate(10, 1);
  CHECK(ten.low == Approx(5.425406).epsilon(1e-6));
  CHECK(ten.high == Approx(16.962219).epsilon(1e-6));
  CHECK_FALSE(message_of<core::InputError>([] { core::event_rate(-1, 1); }).empty());
  CHECK_FALSE(message_of<core::InputError>([] { core::event_rate(1, 0); }).empty());
}

TEST_CASE("equal rates are told apart as seldom as the level says, and intervals hold the truth as often") {
  core::Rng rng(7);
  int held = 0, ratio_held = 0, rejected = 0;
  constexpr int kRounds = 2000;
  for (int i = 0; i < kRounds; ++i) {
    const double a = poisson(6, rng), b = poisson(12, rng);
    const auto rate = core::event_rate(a, 3);
    held += rate.low <= 2 && 2 <= rate.high ? 1 : 0;
    const auto both = core::compare_rates(a, 3, b, 6);
    ratio_held += both.ratio.low <= 1 && 1 <= both.ratio.high ? 1 : 0;
    rejected += both.p < 0.1 ? 1 : 0;
  }
  CHECK(held >= 0.89 * kRounds);  // exact intervals hold at least as often as they say
  CHECK(held <= 0.98 * kRounds);
  CHECK(ratio_held >= 0.89 * kRounds);
  CHECK(rejected <= 0.11 * kRounds);
}

TEST_CASE("a comparison is the same both ways round, and knows what it cannot tell") {
  // scipy.stats.binomtest(20, 25, 0.5): p = 0.00408
  const auto one = core::compare_rates(5, 1, 20, 1), other = core::compare_rates(20, 1, 5, 1);
  CHECK(one.p == Approx(0.0040774).epsilon(1e-4));
  CHECK(other.p == Approx(one.p));
  CHECK(one.ratio.mean == Approx(4));
  CHECK(one.ratio.low == Approx(1 / other.ratio.high));
  CHECK(one.ratio.high == Approx(1 / other.ratio.low));
  CHECK(core::compare_rates(0, 1, 0, 1).p == 1);
  const auto none = core::compare_rates(0, 1, 4, 1);
  CHECK(std::isinf(none.ratio.high));
  CHECK(none.ratio.low > 0);
  CHECK(core::compare_rates(5, 10, 10, 20).p == Approx(1));
}
