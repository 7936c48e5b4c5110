// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

/// Holds a part of a frame that is sketched by itself.
struct Tile {
  cv::Rect core;  ///< px; the cores of all tiles part the frame
  cv::Rect read;  ///< px: the core with a margin, cut at the frame's border
};

/// Parts a frame into tiles whose cores are about equally large, at most `side` px wide and high. Row by row.
std::vector<Tile> make_tiles(cv::Size frame, int side, int margin);

/// Joins the sketches of tiles, each in the coordinates of its tile's `read`. A patch is kept by the tile in
/// whose core it lies. Where an edge leaves the core, it is tied to the patch from which the next tile's edge
/// of the same curve comes: across no farther than 2.5 px, nearest first. Ids count from 0; types are named
/// anew. `spacing`: px from patch to patch. O(patches).
graph::AttributeGraph join_tiles(const std::vector<Tile>& tiles,
                                 const std::vector<graph::AttributeGraph>& sketches, double spacing);

}  // namespace emberfold::sketch
