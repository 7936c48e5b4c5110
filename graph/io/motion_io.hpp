// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <iosfwd>
#include <string_view>
#include <vector>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::graph {

/// Writes sketch.jsonl: a header line, then one line per frame (docs/architecture.md, "Files").
/// Numbers read back to the same bits. Throws InputError for a graph that the readers would refuse, IoError
/// if the stream fails.
void write_sketch(std::ostream& out, const SketchSequence& sketch);
/// Writes sketch.jsonl frame after frame, as write_sketch does the whole of it; errors likewise.
class SketchWriter {
 public:
  /// `out`: of a kind that can be overwritten, for the header comes last.
  SketchWriter(std::ostream& out, int width, int height, double fps);
  /// Writes a frame; its vertices are renumbered as SketchSequence::append does.
  void add(const AttributeGraph& graph);
  void finish();

 private:
  std::ostream& out_;
  SketchSequence last_;  ///< the last frame that has vertices, alone
  std::size_t frames_ = 0;
};
/// Writes motion.jsonl, which holds the links too; otherwise as write_sketch.
void write_motion(std::ostream& out, const MotionGraph& motion);

/// Reads sketch.jsonl, or motion.jsonl without its links.
/// `name`, of the file for example, begins every message. Throws IoError, naming line and cause, for another
/// format, a newer version, more or fewer frames than the header promises, wrong types or sizes, and missing
/// or repeated ids.
SketchSequence read_sketch(std::istream& in, std::string_view name);
/// Reads motion.jsonl; errors as for read_sketch.
MotionGraph read_motion(std::istream& in, std::string_view name);

/// Writes events.json.
/// Throws InputError for a negative frame, a position that is not finite or a probability outside 0…1,
/// IoError if the stream fails.
void write_events(std::ostream& out, const std::vector<Event>& events);
/// Writes events.csv; errors as for write_events.
void write_events_csv(std::ostream& out, const std::vector<Event>& events);
/// Reads events.json, or truth.json of a scene: an object with a list "events" of {frame, type, x, y}.
/// Throws IoError, beginning with `name`, for anything else.
std::vector<Event> read_events(std::istream& in, std::string_view name);

/// Writes trajectories.csv, a row for each patch and frame.
/// Columns: trajectory, frame, vertex, stroke, x, y, theta, width, blur, contrast.
void write_trajectories(std::ostream& out, const MotionGraph& motion);

/// Writes strokes.csv, a row for each stroke and frame, stroke after stroke.
/// Columns: stroke (0: not identified), frame, x, y (its middle, px, half way along the longest of its
/// shortest paths), length (px, of all its edges), patches, width (px) and contrast (means over the patches),
/// ends (patches with one neighbour), junctions (with three or more). O(n log n).
void write_strokes(std::ostream& out, const MotionGraph& motion);

}  // namespace emberfold::graph
