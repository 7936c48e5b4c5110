// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/diagnostics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>

#include "core/error.hpp"

namespace emberfold::mcmc {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kFewest = 4;  // draws of a chain: two in each half have a variance

/// Draws of several chains one after the other, `length` of each.
struct Draws {
  std::vector<double> values;
  std::size_t length = 0;
  [[nodiscard]] std::size_t chains() const { return length == 0 ? 0 : values.size() / length; }
  [[nodiscard]] std::span<const double> chain(std::size_t c) const {
    return std::span(values).subspan(c * length, length);
  }
};

std::size_t common_length(std::span<const std::vector<double>> chains) {
  if (chains.empty()) return 0;
  for (std::size_t c = 1; c < chains.size(); ++c) {
    if (chains[c].size() == chains[0].size()) continue;
    throw core::InputError("diagnosing chains: chain " + std::to_string(c) + " has " +
                           std::to_string(chains[c].size()) + " draws, chain 0 has " +
                           std::to_string(chains[0].size()) + "; all must have the same number");
  }
  return chains[0].size();
}

Draws halves(std::span<const std::vector<double>> chains, std::size_t length) {
  Draws split;
  split.length = length / 2;
  for (const auto& chain : chains) {
    const auto half = static_cast<std::ptrdiff_t>(split.length);
    split.values.insert(split.values.end(), chain.begin(), chain.begin() + half);
    split.values.insert(split.values.end(), chain.end() - half, chain.end());
  }
  return split;
}

double mean(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Variance with the divisor n − 1, of at least two values.
double variance(std::span<const double> values) {
  const double centre = mean(values);
  double sum = 0;
  for (const double v : values) sum += (v - centre) * (v - centre);
  return sum / static_cast<double>(values.size() - 1);
}

bool constant(std::span<const double> values) {
  return std::ranges::all_of(values, [&](double v) { return v == values.front(); });
}

/// z with Φ(z) = p for p in (0, 1): Abramowitz & Stegun 26.2.23, then Halley's steps.
double normal_quantile(double p) {
  if (p > 0.5) return -normal_quantile(1 - p);
  const double t = std::sqrt(-2 * std::log(p));
  double z =
      (2.515517 + t * (0.802853 + t * 0.010328)) / (1 + t * (1.432788 + t * (0.189269 + t * 0.001308))) - t;
  for (int step = 0; step < 2; ++step) {
    const double density = std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
    const double off = (std::erfc(-z / std::numbers::sqrt2) / 2 - p) / density;
    z -= off / (1 + z * off / 2);
  }
  return z;
}

/// Normal scores of the ranks over all chains, ties at their average rank (eq. 14).
Draws normal_scores(const Draws& draws) {
  const std::size_t count = draws.values.size();
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return draws.values[i]; });
  Draws scores{std::vector<double>(count), draws.length};
  for (std::size_t first = 0, end = 0; first < count; first = end) {
    for (end = first + 1; end < count && draws.values[order[end]] == draws.values[order[first]];) ++end;
    const double rank = static_cast<double>(first + 1 + end) / 2;  // ranks first + 1 … end
    const double z = normal_quantile((rank - 0.375) / (static_cast<double>(count) + 0.25));
    for (std::size_t k = first; k < end; ++k) scores.values[order[k]] = z;
  }
  return scores;
}

/// The quantile between order statistics, as R's default (type 7).
double quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  const double at = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (at - static_cast<double>(below)) * (values[above] - values[below]);
}

Draws folded(const Draws& draws) {
  const double median = quantile(draws.values, 0.5);
  Draws away = draws;
  for (double& v : away.values) v = std::abs(v - median);
  return away;
}

Draws indicator(const Draws& draws, double share) {
  const double bound = quantile(draws.values, share);
  Draws below = draws;
  for (double& v : below.values) v = v <= bound ? 1 : 0;
  return below;
}

/// W, the mean variance within chains, and the pooled one (eqs. 1–3).
struct Variances {
  double within = 0, pooled = 0;
};
Variances variances(const Draws& draws) {
  const auto n = static_cast<double>(draws.length);
  std::vector<double> means;
  Variances result;
  for (std::size_t c = 0; c < draws.chains(); ++c) {
    means.push_back(mean(draws.chain(c)));
    // The mean of equal numbers may be off by rounding, which must not give a variance.
    result.within += constant(draws.chain(c)) ? 0 : variance(draws.chain(c));
  }
  result.within /= static_cast<double>(draws.chains());
  result.pooled = (n - 1) / n * result.within + variance(means);
  return result;
}

/// eq. 4
double plain_rhat(const Draws& draws) {
  if (constant(draws.values)) return kUnknown;
  const auto [within, pooled] = variances(draws);
  if (within <= 0) return std::numeric_limits<double>::infinity();
  return std::sqrt(pooled / within);
}

/// Autocovariances with the divisor n, mean over the chains, each lag computed on demand.
class Autocovariance {
 public:
  explicit Autocovariance(const Draws& draws) : deviations_(draws) {
    for (std::size_t c = 0; c < draws.chains(); ++c) {
      const double centre = mean(draws.chain(c));
      for (std::size_t i = 0; i < draws.length; ++i) deviations_.values[c * draws.length + i] -= centre;
    }
  }
  [[nodiscard]] double operator()(std::size_t lag) const {
    double sum = 0;
    for (std::size_t c = 0; c < deviations_.chains(); ++c) {
      const auto d = deviations_.chain(c);
      for (std::size_t i = 0; i + lag < d.size(); ++i) sum += d[i] * d[i + lag];
    }
    return sum / static_cast<double>(deviations_.values.size());
  }

 private:
  Draws deviations_;
};

/// eqs. 10–13
double plain_size(const Draws& draws) {
  if (constant(draws.values)) return kUnknown;
  const auto [within, pooled] = variances(draws);
  const Autocovariance autocovariance(draws);
  const auto rho = [&, w = within, p = pooled](std::size_t lag) {
    return lag == 0 ? 1.0 : 1 - (w - autocovariance(lag)) / p;
  };
  double time = -1, least = 2;
  for (std::size_t lag = 0; lag + 1 < draws.length; lag += 2) {
    const double even = rho(lag), pair = even + rho(lag + 1);
    if (pair <= 0) {
      time += std::max(0.0, std::min(even, least));  // the odd lag alone made the pair negative
      break;
    }
    least = std::min(least, pair);
    time += 2 * least;
  }
  const auto count = static_cast<double>(draws.values.size());
  return count / std::max(time, 1 / std::log10(count));
}

double larger(double a, double b) {
  return std::isnan(a) || b > a ? b : a;
}
double smaller(double a, double b) {
  return std::isnan(a) || b < a ? b : a;
}

}  // namespace

Diagnosis diagnose(std::span<const std::vector<double>> chains) {
  Diagnosis result{kUnknown, kUnknown, kUnknown, kUnknown, kUnknown, kUnknown};
  const std::size_t length = common_length(chains);
  std::vector<double> all;
  for (const auto& chain : chains) all.insert(all.end(), chain.begin(), chain.end());
  if (all.empty() || !std::ranges::all_of(all, [](double v) { return std::isfinite(v); })) return result;
  if (constant(all)) {
    result.mean = all.front();
    result.deviation = 0;
    if (length >= kFewest) result.error = 0;
    return result;
  }
  result.mean = mean(all);
  result.deviation = std::sqrt(variance(all));
  if (length < kFewest) return result;
  const Draws draws = halves(chains, length);
  const Draws scores = normal_scores(draws);
  result.rhat = larger(plain_rhat(scores), plain_rhat(normal_scores(folded(draws))));
  result.bulk_ess = plain_size(scores);
  result.tail_ess = smaller(plain_size(indicator(draws, 0.05)), plain_size(indicator(draws, 0.95)));
  result.error = result.deviation / std::sqrt(plain_size(draws));
  return result;
}

double effective_size(std::span<const std::vector<double>> chains) {
  const std::size_t length = common_length(chains);
  if (length < kFewest) return kUnknown;
  for (const auto& chain : chains)
    if (!std::ranges::all_of(chain, [](double v) { return std::isfinite(v); })) return kUnknown;
  return plain_size(halves(chains, length));
}

}  // namespace emberfold::mcmc
