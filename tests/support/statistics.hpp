// SPDX-License-Identifier: Apache-2.0
// Probability of a sample, for tests of random numbers.
#pragma once

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

namespace emberfold::test {

/// Q(a, x), the regularised upper incomplete gamma function; a > 0, x ≥ 0. Series below x = a + 1, Lentz's
/// continued fraction above; relative error about 1e-12.
inline double gamma_q(double a, double x) {
  const double factor = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x <= 0) return 1;
  if (x < a + 1) {
    double term = 1 / a, sum = term;
    for (int n = 1; n < 10000 && term > 1e-17 * sum; ++n) {
      term *= x / (a + n);
      sum += term;
    }
    return 1 - factor * sum;
  }
  double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;
  for (int n = 1; n < 10000; ++n) {
    const double step = -n * (n - a);
    b += 2;
    d = 1 / (step * d + b);
    c = b + step / c;
    h *= c * d;
    if (std::abs(c * d - 1) < 1e-15) break;
  }
  return factor * h;
}

/// The probability that a sample of these expected counts deviates from them as much or more (Pearson's χ²,
/// one degree of freedom less than bins). Expected counts are at least 5.
inline double chi_squared_p(const std::vector<double>& expected, const std::vector<std::size_t>& counted) {
  if (expected.size() != counted.size() || expected.size() < 2) throw std::logic_error("bins differ");
  double sum = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (!(expected[i] >= 5)) throw std::logic_error("a bin is expected to be nearly empty");
    const double deviation = static_cast<double>(counted[i]) - expected[i];
    sum += deviation * deviation / expected[i];
  }
  return gamma_q(static_cast<double>(expected.size() - 1) / 2, sum / 2);
}

/// Returns the p-value for equally likely bins.
inline double uniform_p(const std::vector<std::size_t>& counted) {
  double total = 0;
  for (const std::size_t count : counted) total += static_cast<double>(count);
  return chi_squared_p(std::vector<double>(counted.size(), total / static_cast<double>(counted.size())),
                       counted);
}

inline double normal_cdf(double x) {
  return 0.5 * std::erfc(-x / std::sqrt(2.0));
}

}  // namespace emberfold::test
