// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/clip.hpp"
#include "graph/events/events.hpp"

namespace emberfold::graph {

/// Converts frames to times and positions to places: the one owner of when and where frames were taken.
struct Units {
  std::optional<double> seconds;   ///< mean from frame to frame, where known
  std::optional<double> um;        ///< side of a pixel, µm, where known
  std::vector<double> times = {};  ///< s of each frame, where they are not evenly spaced
  core::ClipOrigin origin = {};

  /// Returns the time of a frame, s. Beyond the last of `times` it continues by the mean.
  [[nodiscard]] double time(int frame) const;
  /// Returns the time from frame `first` to frame `last`, s.
  [[nodiscard]] double span(int first, int last) const;
  /// Returns the mean time from frame to frame between two, s, > 0.
  [[nodiscard]] double step(int first, int last) const;
  /// Returns a position of the clip, px, counted as `origin` says.
  [[nodiscard]] Point place(Point position) const;
};

/// Returns the units of a clip; a rate that is a guess gives no seconds.
Units units_of(const core::ClipInfo& info);

/// Returns events with `by` added to their positions.
std::vector<Event> moved(std::vector<Event> events, Point by);

}  // namespace emberfold::graph
