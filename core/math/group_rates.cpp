// SPDX-License-Identifier: Apache-2.0
#include "core/math/group_rates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/beta.hpp>

#include "core/error.hpp"
#include "core/rng.hpp"

namespace emberfold::core {

namespace {

constexpr double kMostWays = 20000, kLeastWays = 20;

CountedClip total(std::span<const CountedClip> clips) {
  CountedClip sum;
  for (const auto& clip : clips) sum.count += clip.count, sum.exposure += clip.exposure;
  return sum;
}

/// Pearson's statistic of counts about the group's own rate.
double pearson(std::span<const CountedClip> clips) {
  const auto all = total(clips);
  double sum = 0;
  for (const auto& clip : clips) {
    const double expected = all.count * clip.exposure / all.exposure;
    if (expected > 0) sum += (clip.count - expected) * (clip.count - expected) / expected;
  }
  return sum;
}

double dispersion_of(double statistic, double freedom) {
  return freedom > 0 ? std::max(1., statistic / freedom) : 1;
}

/// The square of the ratio of Student's quantile to the normal one; 1 where nothing was estimated.
double widening(double dispersion, double freedom, double level) {
  if (dispersion <= 1 || freedom <= 0) return 1;
  const double upper = (1 + level) / 2;
  const double ratio = boost::math::quantile(boost::math::students_t(freedom), upper) /
                       boost::math::quantile(boost::math::normal(), upper);
  return ratio * ratio;
}

void check_group(std::span<const CountedClip> clips, double level) {
  if (clips.empty()) throw InputError("a group of no clips has no rate");
  for (const auto& clip : clips) event_rate(clip.count, clip.exposure, level);
}

double ways_to_choose(std::size_t all, std::size_t some) {
  double ways = 1;
  for (std::size_t i = 0; i < some; ++i)
    ways = ways * static_cast<double>(all - i) / static_cast<double>(i + 1);
  return std::round(ways);
}

/// Returns how far the ratio of the rates is from 1; half an event more in each, for groups without any.
double distance(const CountedClip& a, const CountedClip& b) {
  return std::abs(std::log((a.count + 0.5) / a.exposure) - std::log((b.count + 0.5) / b.exposure));
}

/// Share of the assignments of clips to groups in which these differ at least as much.
double permutation_p(std::span<const CountedClip> first, std::span<const CountedClip> second, double ways,
                     std::uint64_t seed) {
  constexpr double kAlike = 1e-9;
  std::vector<CountedClip> clips(first.begin(), first.end());
  clips.insert(clips.end(), second.begin(), second.end());
  const auto everything = total(clips);
  const double own = distance(total(first), total(second)) - kAlike;
  const auto is_as_far = [&](const CountedClip& a) {
    return distance(a, {everything.count - a.count, everything.exposure - a.exposure}) >= own;
  };
  if (ways <= kMostWays) {
    std::vector<char> chosen(clips.size(), 0);
    std::fill_n(chosen.begin(), first.size(), 1);
    double hits = 0;
    do {
      CountedClip a;
      for (std::size_t i = 0; i < clips.size(); ++i)
        if (chosen[i] != 0) a.count += clips[i].count, a.exposure += clips[i].exposure;
      hits += is_as_far(a) ? 1 : 0;
    } while (std::prev_permutation(chosen.begin(), chosen.end()));
    return hits / ways;
  }
  Rng rng(seed, {0x67726f75});
  double hits = 1;  // the actual assignment is one of them
  for (int draw = 0; draw < static_cast<int>(kMostWays); ++draw) {
    for (std::size_t i = 0; i < first.size(); ++i)
      std::swap(clips[i], clips[i + rng.below(static_cast<std::uint32_t>(clips.size() - i))]);
    hits += is_as_far(total(std::span(clips).first(first.size()))) ? 1 : 0;
  }
  return hits / (kMostWays + 1);
}

}  // namespace

GroupRate group_rate(std::span<const CountedClip> clips, double level) {
  check_group(clips, level);
  const double freedom = static_cast<double>(clips.size()) - 1;
  GroupRate found;
  found.dispersion = dispersion_of(pearson(clips), freedom);
  const auto all = total(clips);
  const double less = found.dispersion * widening(found.dispersion, freedom, level);
  found.rate = event_rate(all.count / less, all.exposure / less, level);
  return found;
}

GroupComparison compare_groups(std::span<const CountedClip> first, std::span<const CountedClip> second,
                               double level, std::uint64_t seed) {
  check_group(first, level), check_group(second, level);
  const auto a = total(first), b = total(second);
  const auto independent = compare_rates(a.count, a.exposure, b.count, b.exposure, level);
  const double freedom = static_cast<double>(first.size() + second.size()) - 2;
  GroupComparison found{independent.ratio, dispersion_of(pearson(first) + pearson(second), freedom),
                        independent.p, false};
  if (found.dispersion > 1 && a.count + b.count > 0) {
    // As in compare_rates, of counts divided by the dispersion: these are not whole.
    const double less = found.dispersion * widening(found.dispersion, freedom, level), tail = (1 - level) / 2;
    const auto ratio = [&](double success) { return success / (1 - success) * a.exposure / b.exposure; };
    const double one = a.count / less, other = b.count / less;
    found.ratio.low = other > 0 ? ratio(boost::math::ibeta_inv(other, one + 1, tail)) : 0;
    found.ratio.high = one > 0 ? ratio(boost::math::ibetac_inv(other + 1, one, tail))
                               : std::numeric_limits<double>::infinity();
  }
  const double ways = ways_to_choose(first.size() + second.size(), first.size());
  if (ways >= kLeastWays) found.p = permutation_p(first, second, ways, seed), found.permuted = true;
  return found;
}

}  // namespace emberfold::core
