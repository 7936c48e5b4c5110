// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace emberfold::core {

/// An estimate and the ends of its interval.
struct Interval {
  double mean = 0, low = 0, high = 0;
};

/// Returns the rate of independent events and its exact interval (Garwood 1936). `count`: of events, ≥ 0;
/// `exposure`: time, or time × area, in which they were counted, > 0; `level`: of the interval, in (0, 1).
/// Throws core::InputError.
Interval event_rate(double count, double exposure, double level = 0.9);

/// Comparison of two rates.
struct RateComparison {
  Interval ratio;  ///< of the second rate to the first; high is infinite where the first has no event
  double p = 1;    ///< probability of counts at least as unlikely, if the rates are the same
};

/// Compares the rates of independent events, by the exact test of one count given their sum (Przyborowski &
/// Wilenski 1940); the ratio's interval is that of Clopper & Pearson (1934). Throws core::InputError as
/// event_rate does, and for counts that are not whole. O(sum of the counts).
RateComparison compare_rates(double count_a, double exposure_a, double count_b, double exposure_b,
                             double level = 0.9);

}  // namespace emberfold::core
