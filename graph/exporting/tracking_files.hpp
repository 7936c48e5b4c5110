// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>

#include "graph/exporting/stroke_tree.hpp"

// Strokes and curves in the formats of other programs.
namespace emberfold::graph {

/// Data of the clip that is written with a tree.
struct TrackedClip {
  std::string name;
  int width = 0, height = 0, frames = 0;
  double fps = 25;
  Units units;  ///< times are in frames, places in px where they are not known
};

/// Writes a file of an export: its path below the export's folder, and its content.
using WriteFile =
    std::function<void(const std::string& path, const std::function<void(std::ostream&)>& body)>;

/// Writes a GEFF (graph exchange file format 1.1.0): a zarr 2 group of nodes, a stroke (curve) in a frame
/// each, and directed edges. Nodes have t and frame (both the frame's number; the axis t has the seconds of a
/// frame as its `scale`), y, x, stroke (curve), length, and time_s where frames are not evenly spaced; edges
/// probability.
void write_geff(const StrokeTree& tree, const TrackedClip& clip, const std::string& folder,
                const WriteFile& write);

/// Writes a TrackMate file (Fiji, version 7): a spot for each stroke in a frame; all that is linked is a
/// track. The cost of a link is −ln of its probability, 0 where a stroke goes on.
void write_trackmate(std::ostream& out, const StrokeTree& tree, const TrackedClip& clip);

/// Writes the strokes' genealogy as GraphML: a node for each stroke with its first and last frame, an edge
/// for each event that leads from one to another.
void write_graphml(std::ostream& out, const StrokeTree& tree, const TrackedClip& clip);

}  // namespace emberfold::graph
