// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <iosfwd>
#include <vector>

#include "graph/events/events.hpp"
#include "graph/io/units.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::graph {

// In all tables and events.json `x`, `y` and times count as `units.origin` says; where it says something, the
// last column is counted_from (source or part).

/// Writes events.json; positions count as in the tables. Errors as for the plain one.
void write_events(std::ostream& out, const std::vector<Event>& events, const Units& units);

/// Writes trajectories.csv, the columns counted_from behind the others.
void write_trajectories(std::ostream& out, const MotionGraph& motion, const Units& units);

/// Writes events.csv with the columns time_s, x_um and y_um behind the others, where the units are known.
/// Errors as for write_events.
void write_events_csv(std::ostream& out, const std::vector<Event>& events, const Units& units);

/// A stroke in one frame, as a row of strokes.csv.
struct StrokeRow {
  std::uint32_t stroke = 0, frame = 0, patches = 0, ends = 0, junctions = 0;
  std::uint32_t pieces = 1;  ///< parts that no edges within the stroke join
  Point middle;              ///< px, half way along the longest shortest path of its longest piece
  double length = 0, width = 0, contrast = 0;  ///< px, px, luma
};

/// Returns a row for every stroke and frame, stroke after stroke.
std::vector<StrokeRow> stroke_rows(const MotionGraph& motion);

/// Writes strokes.csv with the columns time_s, x_um, y_um and length_um behind the others, where the units
/// are known.
void write_strokes(std::ostream& out, const MotionGraph& motion, const Units& units);

/// The life of one stroke.
struct StrokeLife {
  std::uint32_t stroke = 0;
  int first = 0, last = 0;  ///< frames
  bool whole = false;       ///< it was neither there in the clip's first frame nor in its last
  double length = 0;        ///< px, mean over its frames
  double growth = 0;        ///< px a frame: slope of the length by least squares; 0 of one frame
  double speed = 0;         ///< px a frame: mean distance of its middles in frames that follow each other
  [[nodiscard]] int frames() const { return last - first + 1; }
};

/// Returns the lives of the strokes, by their identities, which must be set. O(vertices log vertices).
std::vector<StrokeLife> stroke_lives(const MotionGraph& motion);

/// Writes lives.csv, a row for each stroke: stroke, first, last, frames, whole (1 or 0), length, growth,
/// speed, and where the units are known life_s, length_um, growth_um_s, speed_um_s (the last two need both
/// units).
void write_lives(std::ostream& out, const std::vector<StrokeLife>& lives, const Units& units);

}  // namespace emberfold::graph
