// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "graph/events/events.hpp"

namespace emberfold::graph {

struct PoolOptions {
  int frames = 1;      ///< 0…100: events of two samples at most so many frames apart may be the same
  double radius = 10;  ///< px, > 0: and at most so far
  /// The samples are of so many independent readings of the clip, as many of each, one reading after the
  /// other: 0…samples, a divisor of their number. 0: probabilities are the shares themselves.
  std::size_t readings = 0;
  void validate() const;
};

/// The events of a clip as samples of its posterior see them, all samples of equal weight. Each event is
/// listed once, at the frame at which most samples have it and the median of their places there. Its
/// probability is the share of samples that have an event of its class within `frames` and `radius` of that,
/// where an event of a sample counts for one listed event only. Samples that agree on a union, or a
/// separation, but not on its class (merge or connect, split or disconnect) make one event of the more
/// frequent class, merge and split where both are as frequent; its probability is that of the class, but
/// where it is below ½ and that of either is not, it is the probability of either. `before` and `after` name
/// the strokes of samples[representative], where that sample has the event; else they are empty.
///
/// With `readings`, N of them, a share is drawn towards ½ by as much as readings of this clip differ: p = (a
/// + N share) / (2a + N), a by the method of moments from how often what one reading has another has too. So
/// p tells how often a further reading would have the event; p ≥ ½ where the share is.
///
/// Pooling is the same for samples in any order (of readings, and inside of each), and reversed samples give
/// the reversed events. Ordered as sort_events orders. InputError: no samples, no sample `representative`, a
/// place that is not finite. O(n log n) in the events of all samples, times how many of them lie near each
/// other.
std::vector<Event> pool_events(std::span<const std::vector<Event>> samples, std::size_t representative = 0,
                               const PoolOptions& options = {});

/// The sample whose events agree most with those of all: where Σ (probability − ½) over its events is
/// greatest, the probability of a union or a separation being that of either class; the first of several.
std::size_t representative(std::span<const std::vector<Event>> samples, const PoolOptions& options = {});

}  // namespace emberfold::graph
