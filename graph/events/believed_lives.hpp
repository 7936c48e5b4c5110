// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <span>
#include <vector>

#include "graph/events/events.hpp"

namespace emberfold::graph::detail {

/// What a stroke is over time, and what is believed of its ends.
struct Life {
  std::size_t first = 0, last = 0;  ///< frames
  std::size_t frames = 0, patches = 0;
  std::size_t closed = 0;             ///< frames in which it has no tip
  bool begins = false, ends = false;  ///< by a believed event
  /// With the clip, at a cut, or through the picture's border, which is no event.
  bool comes_in = false, goes_out = false;

  /// Returns whether it is the outline of a thing: closed, and more than 100 px long.
  [[nodiscard]] bool is_thing() const;
};

/// The events that are believed, by frame; one frame more than the clip has.
using Believed = std::vector<std::vector<const Event*>>;
Believed believed_events(std::span<const Event> events, double least, std::size_t frames);

/// Follows the named strokes of a motion graph. `cuts`: frames at which the picture changes. O(n log n).
std::map<SubgraphId, Life> believed_lives(const MotionGraph& motion, const Believed& believed,
                                          std::span<const int> cuts);

/// Returns whether a stroke is in a list.
bool names(std::span<const SubgraphId> strokes, SubgraphId stroke);

}  // namespace emberfold::graph::detail
