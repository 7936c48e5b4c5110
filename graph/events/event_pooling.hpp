// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "graph/events/events.hpp"

namespace emberfold::graph {

/// Options of pool_events.
struct PoolOptions {
  int frames = 1;      ///< 0…100: tolerance in time between two samples of one event, frames
  double radius = 10;  ///< > 0: tolerance in place, px
  /// Number of independent readings of the clip, 0 or a divisor of the number of samples. Each reading gives
  /// equally many consecutive samples. 0: probabilities are the plain shares.
  std::size_t readings = 0;
  /// Throws InputError naming field, value and range.
  void validate() const;
};

/// Pools the events of posterior samples of equal weight into one list with probabilities.
///
/// - Frame and position: the frame at which most samples have the event, and the median of their positions.
/// - Probability: the share of samples with an event of the class within `frames` and `radius`. An event of a
///   sample counts for one listed event only.
/// - Class: samples that agree on a union (merge, connect) or a separation (split, disconnect) but not on its
///   class give one event of the more frequent class; merge and split win ties. If only the share of both
///   classes together reaches ½, that share is the probability.
/// - `before` and `after`: the strokes of samples[representative]; empty if that sample lacks the event.
///
/// With N = `readings` > 1 a share s is shrunk to p = (a + N s) / (2a + N), a Beta(a, a) prior: p is the
/// probability that a further reading has the event. a comes from the method of moments on how often an event
/// of one reading recurs in another.
///
/// The order of samples (of readings, and within each) does not matter; time-reversed samples give the
/// time-reversed events. Sorted as by sort_events. Throws InputError for no samples, an invalid
/// `representative`, or a position that is not finite. O(n log n) in all events, times the number of close
/// ones.
std::vector<Event> pool_events(std::span<const std::vector<Event>> samples, std::size_t representative = 0,
                               const PoolOptions& options = {});

/// Finds the sample whose events agree most with those of all samples.
/// It maximises Σ (probability − ½) over its events, where a union or separation has the probability of both
/// of its classes together; the first of several. Throws InputError as pool_events does.
std::size_t find_representative(std::span<const std::vector<Event>> samples, const PoolOptions& options = {});

}  // namespace emberfold::graph
