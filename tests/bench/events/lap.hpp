// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"

// A peer: tracking by linear assignment, first from frame to frame, then of the tracks' pieces to each other
// for gaps, splits and merges (Jaqaman et al. 2008, "Robust single-particle tracking in live-cell time-lapse
// sequences", as TrackMate and LapTrack do it).
namespace emberfold::figures {

/// Cost of linking two strokes.
enum class LapCost {
  middles,  ///< the squared distance of their middles, px²
  overlap  ///< 1 − intersection over union of their patches, two within 6 px being one; for a split or merge
           ///< 1 − the share of the smaller piece that lies in the whole
};

struct LapOptions {
  LapCost cost = LapCost::middles;
  double link = 225;      ///< the largest cost of a link from frame to frame; not to link costs 1.05 of it
  double branch = 225;    ///< the same for splits and merges; 0: none
  int gap = 2;            ///< frames that a track may miss
  std::size_t least = 1;  ///< frames: events of shorter pieces are left out
};

/// Points are strokes: components of each frame's graph. Where a link is unlikely a track begins or ends: a
/// birth or a death. A split or merge is put in the middle of what joined the pieces, or half way between
/// them: trackers of points put it at one of the points, far from where long strokes meet.
std::vector<graph::Event> lap_strokes(const graph::SketchSequence& sketch, const LapOptions& options);

/// Points are patches, linked from frame to frame at the least sum of squared distances, none above
/// `distance` px; the events of strokes are read off these links as those of our own.
std::vector<graph::Event> lap_patches(graph::SketchSequence sketch, double distance);

}  // namespace emberfold::figures
