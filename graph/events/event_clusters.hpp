// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/events/event_pooling.hpp"

namespace emberfold::graph::detail {

/// Classes that samples may take for each other; a reversal swaps the first two, and the last two.
enum class Family : std::uint8_t { birth, death, unite, separate };
Family family(EventType type);

/// One event of one sample.
struct Sighting {
  int time = 0;  ///< the frame, negative where a reversal makes the family one that counts forwards
  Point place;
  bool bridge = false;  ///< connect or disconnect
  std::uint32_t sample = 0, event = 0;
};

/// One event of the world: at most one sighting of each sample.
struct Cluster {
  int time = 0;
  Point place;
  std::vector<Sighting> members;  ///< ordered by time, then place
  [[nodiscard]] std::size_t bridges() const;
};

/// The sightings of one family in clusters, each member within the tolerance of its cluster's time and place.
/// First greedily about the sightings that most samples share; then each sample's sightings go to the
/// clusters that they suit best as a whole, and the clusters to where their members are, some times over.
std::vector<Cluster> clusters(std::vector<Sighting> sightings, std::size_t samples,
                              const PoolOptions& options);

}  // namespace emberfold::graph::detail
