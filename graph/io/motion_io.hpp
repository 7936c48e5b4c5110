// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string_view>
#include <vector>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::graph {

/// JSON Lines: a header line, then a line a frame (docs/architecture.md, "Files"). Numbers are written so
/// that they read back the same.
void write_sketch(std::ostream& out, const SketchSequence& sketch);
void write_motion(std::ostream& out, const MotionGraph& motion);

/// The inverses. `name` (a file's, say) begins every message. core::IoError, naming line and cause, for
/// another format, a newer version, a file that ends before the frames its header promises or goes on after
/// them, wrong types or sizes, ids that do not exist or repeat. read_sketch takes a motion file too and
/// leaves its links.
SketchSequence read_sketch(std::istream& in, std::string_view name);
MotionGraph read_motion(std::istream& in, std::string_view name);

/// events.json and events.csv.
void write_events(std::ostream& out, const std::vector<Event>& events);
void write_events_csv(std::ostream& out, const std::vector<Event>& events);
/// Reads events.json, or a truth.json of a scene: any object with a list "events" of {frame, type, x, y}.
std::vector<Event> read_events(std::istream& in, std::string_view name);

/// trajectories.csv: a row for each patch and frame: trajectory, frame, vertex, stroke, x, y, theta, width,
/// blur, contrast.
void write_trajectories(std::ostream& out, const MotionGraph& motion);

/// strokes.csv: a row for each stroke and frame, stroke after stroke: stroke, frame, x, y (its middle, px,
/// half way along the longest of its shortest paths), length (px, of all its edges), patches, width (px) and
/// contrast (means over the patches), ends (patches with one neighbour), junctions (with three or more). A
/// stroke that is not identified has the number 0. O(n log n).
void write_strokes(std::ostream& out, const MotionGraph& motion);

}  // namespace emberfold::graph
