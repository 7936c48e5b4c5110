// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/events/event_pooling.hpp"

namespace emberfold::graph::detail {

/// Groups of event classes that samples may confuse with each other.
/// Reversing time swaps birth with death, and unite with separate.
enum class Family : std::uint8_t { birth, death, unite, separate };
/// Returns the family of an event class.
Family family(EventType type);

/// One event in one sample.
struct Observation {
  int time = 0;  ///< frame; negated for deaths and separations, so that reversing time changes nothing
  Point place;
  bool bridge = false;  ///< connect or disconnect
  std::uint32_t sample = 0, event = 0;
};

/// One event of the clip: at most one observation of each sample.
struct Cluster {
  int time = 0;
  Point place;
  std::vector<Observation> members;  ///< ordered by time, then place
  /// Returns how many members are a connect or disconnect.
  [[nodiscard]] std::size_t bridge_count() const;
};

/// Clusters the observations of one family in time and place.
/// Each member lies within the tolerance of its cluster. Clusters are first formed greedily around the
/// observations that most samples share. Then assignment (each sample's observations to clusters, optimally)
/// and re-centring alternate a few times. The result does not depend on the order of the samples.
std::vector<Cluster> cluster_observations(std::vector<Observation> observations, std::size_t samples,
                                          const PoolOptions& options);

}  // namespace emberfold::graph::detail
