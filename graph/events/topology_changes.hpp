// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "graph/events/event_names.hpp"
#include "graph/events/events.hpp"

namespace emberfold::graph {

/// Change of a network: one of the six classes of events, or one that leaves its strokes unchanged.
enum class Change : std::uint8_t {
  birth,
  death,
  split,
  merge,
  connect,
  disconnect,
  ring_closed,
  ring_opened,
  branch_extruded,
  branch_retracted,
  enters,  ///< a stroke, through the picture's border
  leaves,
  t1,
};
/// Returns the name of a change as files write it.
std::string_view name(Change change);

/// A change between frames `frame` − 1 and `frame`, and what it adds to the figures of the network.
struct TopologyChange {
  int frame = 0;
  Change change = Change::birth;
  Point position;                   ///< px
  Contact contact = Contact::none;  ///< of unions, separations and rings
  int tips = 0;                     ///< a single patch counts as two
  int branches = 0;                 ///< neighbours beyond two, at junctions
  int components = 0, loops = 0;
  double length = 0;  ///< px, of a branch, from its junction to its tip; else 0
  bool operator==(const TopologyChange&) const = default;
};

/// Finds all that changes in the topology of a motion graph, so that in every frame, and in all strokes that
/// links join, the changes of tips, branches (NetworkFigures, with 2 · points in the tips), components and
/// loops are the sums over what is found. Unions and separations are those of stroke_events(), by their
/// contact; loops that close or open within linked strokes net of each other are rings; what tips and
/// branches then lack are branches that grew or went. Swaps of neighbours (find_neighbour_swaps) add nothing.
/// Sorted by frame, then change, then place. The strokes must be identified. Throws InputError as
/// validate() does. A stroke that moves in or out through the picture's border, and a ring that the border
/// cuts off, enters or leaves; it is not born and does not die. O(n log n), and the squares of the tips of
/// each cluster.
std::vector<TopologyChange> topology_changes(const MotionGraph& motion);

/// Finds swaps of neighbours (T1 processes): a short edge between two forks shrinks, and one across it grows,
/// so that of the four arms other pairs meet. Both forks are seen for two frames or more before and after, at
/// most ten frames apart; a crossing of two lines, whose forks take turns, is none. O(n log n).
std::vector<TopologyChange> find_neighbour_swaps(const MotionGraph& motion);

}  // namespace emberfold::graph
