// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "graph/events/events.hpp"
#include "graph/io/unit_tables.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::graph {

/// Strokes or curves frame by frame, and what leads from one to another: what tracking tools take.
struct StrokeTree {
  /// From one row to another: the next frame of a stroke, or the first of one that an event made of it.
  struct Link {
    std::size_t from = 0, to = 0;  ///< places in `rows`
    double probability = 1;        ///< of the event; 1 where a stroke goes on
    std::string event;             ///< its class; empty where a stroke goes on
  };
  std::string of = "stroke";    ///< or "curve": what `stroke` of a row is the number of
  std::vector<StrokeRow> rows;  ///< of identified strokes, stroke after stroke, by frame in each
  std::vector<Link> links;
};

/// Makes the tree. An event's link leads from the last frame of a stroke before it to the first of one after
/// it; where these do not follow each other there is none. Two events between two strokes make one link.
StrokeTree make_stroke_tree(const MotionGraph& motion, const std::vector<Event>& events);

/// Makes the tree of the curves, which go on through touches and crossings: links lead from each frame in
/// which a curve is seen to the next, also over gaps. The curves must be identified.
StrokeTree make_curve_tree(const MotionGraph& motion);

}  // namespace emberfold::graph
