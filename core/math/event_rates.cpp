// SPDX-License-Identifier: Apache-2.0
#include "core/math/event_rates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/gamma.hpp>

#include "core/text/check_range.hpp"

namespace emberfold::core {

namespace {

void check(std::string_view what, double count, double exposure, double level) {
  check_not_negative(std::string(what) + " count", count);
  check_positive(std::string(what) + " exposure", exposure);
  check_range("level", level, 1e-6, 1 - 1e-6);
}

}  // namespace

Interval event_rate(double count, double exposure, double level) {
  check("event_rate:", count, exposure, level);
  const double tail = (1 - level) / 2;
  const double low = count > 0 ? boost::math::gamma_p_inv(count, tail) : 0;
  const double high = boost::math::gamma_q_inv(count + 1, tail);
  return {count / exposure, low / exposure, high / exposure};
}

RateComparison compare_rates(double count_a, double exposure_a, double count_b, double exposure_b,
                             double level) {
  check("compare_rates: first", count_a, exposure_a, level);
  check("compare_rates: second", count_b, exposure_b, level);
  if (count_a != std::floor(count_a) || count_b != std::floor(count_b))
    throw InputError("compare_rates: counts must be whole numbers");
  RateComparison found;
  const double all = count_a + count_b, infinite = std::numeric_limits<double>::infinity();
  found.ratio = {count_a > 0 ? count_b / exposure_b / (count_a / exposure_a) : infinite, 0, infinite};
  if (all == 0) {
    found.ratio.mean = 1;
    return found;
  }
  const double share = exposure_b / (exposure_a + exposure_b), tail = (1 - level) / 2;
  // The second count, given the sum, is binomial; its success probability gives the ratio.
  const auto ratio = [&](double success) { return success / (1 - success) * exposure_a / exposure_b; };
  if (count_b > 0) found.ratio.low = ratio(boost::math::ibeta_inv(count_b, count_a + 1, tail));
  if (count_a > 0) found.ratio.high = ratio(boost::math::ibetac_inv(count_b + 1, count_a, tail));
  const boost::math::binomial_distribution<double> given(all, share);
  constexpr double kAlike = 1 + 1e-9;  // probabilities that differ by rounding alone
  const double own = boost::math::pdf(given, count_b);
  double sum = 0;
  for (double k = 0; k <= all; ++k)
    if (const double one = boost::math::pdf(given, k); one <= own * kAlike) sum += one;
  found.p = std::min(1., sum);
  return found;
}

}  // namespace emberfold::core
