// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "core/io/column_folder.hpp"
#include "graph/motion_graph.hpp"
#include "pipeline/sketch_clip.hpp"

// Graphs as columns that store every number of every patch bit by bit.
namespace emberfold::pipeline {

/// Adds the graphs of frames. `frames` (frames + 1 × 2, int64): offsets of each frame's patches and edges; of
/// the patches `numbers` (× 9, float64: x y theta width blur contrast cost gain evidence), `levels` (× 9,
/// float32: left, middle, right of blue, green, red), `types` (uint8: PatchType) and `ids` (× 3, int64:
/// vertex, stroke, curve); `edges` (× 2, int32): the patches of their frame that they join.
void add_graphs(io::Columns& columns, std::span<const graph::AttributeGraph> frames);
/// Reads the graphs, in memory from `memory`. Throws core::IoError where the columns do not fit each other.
std::vector<graph::AttributeGraph> read_graphs(const io::Columns& columns,
                                               const graph::GraphMemory& memory = {});

/// Adds the backgrounds of frames, all of one size: `cells` (frames × rows × columns × channels, float32),
/// `open` (frames × rows × columns, uint8), `seen` (frames × 2 × rows × columns × channels, uint8).
void add_grounds(io::Columns& columns, std::span<const sketch::FrameBackground> grounds);
std::vector<sketch::FrameBackground> read_grounds(const io::Columns& columns);

/// Adds links: `links` (× 2, int64: vertices) and `link_frames` (frames + 1, int64: offsets by frame).
void add_links(io::Columns& columns, std::span<const std::vector<graph::Link>> links);
std::vector<std::vector<graph::Link>> read_links(const io::Columns& columns);

/// Writes what add_graphs, add_grounds and add_links add, some frames at a time. `grounds`: one per frame of
/// the sketch, or none; `links`: none, or those of a motion graph.
void write_graphs(io::ColumnWriter& writer, const graph::SketchSequence& sketch,
                  std::span<const sketch::FrameBackground> grounds,
                  std::span<const std::vector<graph::Link>> links);

}  // namespace emberfold::pipeline
