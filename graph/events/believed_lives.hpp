// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <span>
#include <vector>

#include "graph/events/events.hpp"

namespace emberfold::graph::detail {

/// Extent of a stroke in time, and which of its ends are believed.
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

/// At this probability a change is as likely as none.
inline constexpr double kEven = 0.5;

/// Decides on strokes of which one end is believed and the other one open: they were there with both ends, or
/// not at all. With the odds of both ends multiplied, the open end is believed from here on, or the believed
/// birth or death is no more; other events stay, and so do births and deaths of things and what is certain (a
/// review's facts). An end counts for a probability of 0.1 to 0.6. `lives`: believed at kEven. `events` get
/// the joint probability; returns whether any changed.
bool settle_open_ends(const std::map<SubgraphId, Life>& lives, std::vector<Event>& events);

/// Returns the distance of a place from the picture's border, px; negative outside.
double distance_to_border(const SketchSequence& sketch, Point place);

/// Returns whether a stroke is in a list.
bool names(std::span<const SubgraphId> strokes, SubgraphId stroke);

}  // namespace emberfold::graph::detail
