// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "core/math/event_rates.hpp"

namespace emberfold::core {

/// Events of one clip, and the time (or time × area) in which they were counted.
struct CountedClip {
  double count = 0;     ///< whole, ≥ 0
  double exposure = 0;  ///< > 0
};

/// The rate of a group of clips.
struct GroupRate {
  Interval rate;
  /// Variance of the counts between clips over that of independent events, at least 1; 1 for a single clip.
  double dispersion = 1;
};

/// Returns the rate of a group of clips: all events over all time. Clips differ by more than chance among
/// independent events, so the interval is Garwood's of counts divided by the dispersion (quasi-Poisson;
/// Wedderburn 1974), widened as Student's t is from the normal law, since few clips determine it poorly.
/// Throws core::InputError for no clip, and as event_rate does.
GroupRate group_rate(std::span<const CountedClip> clips, double level = 0.9);

/// Comparison of the rates of two groups of clips.
struct GroupComparison {
  Interval ratio;         ///< of the second group's rate to the first's; ends may be infinite
  double dispersion = 1;  ///< within the groups, by which the interval is widened
  double p = 1;           ///< probability of a ratio as far from 1, if the rates are the same
  /// True: p is over all ways (or 20,000 random ones) to assign the clips to the groups. False: there are
  /// fewer than twenty ways, and p is that of compare_rates, for independent events alone.
  bool permuted = false;
};

/// Compares the rates of two groups of clips, clip by clip, so that clips may differ within a group.
/// Equal clips and seeds give equal results. Throws core::InputError as group_rate does, and for counts that
/// are not whole. O(20,000 clips).
GroupComparison compare_groups(std::span<const CountedClip> first, std::span<const CountedClip> second,
                               double level = 0.9, std::uint64_t seed = 1);

}  // namespace emberfold::core
