// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "graph/motion_graph.hpp"

namespace emberfold::graph {

/// Counts and lengths of the network of one frame. Anchors do not count.
struct NetworkFigures {
  double length = 0;                                                   ///< px, of all edges
  std::uint32_t components = 0;                                        ///< strokes
  std::uint32_t points = 0;                                            ///< strokes of a single patch
  std::uint32_t tips = 0;                                              ///< patches with one neighbour
  std::uint32_t junctions_3 = 0, junctions_4 = 0, junctions_more = 0;  ///< with three, four, more
  std::uint32_t branches = 0;  ///< neighbours beyond two, summed over the junctions
  std::uint32_t loops = 0;     ///< independent ones: edges − patches + components
  std::vector<double> meshes;  ///< px², areas that edges enclose, ascending; what lies inside counts too
  double longest = 0;          ///< px, length of the largest component
  double tortuosity = 1;       ///< length of the paths between tips and junctions over that of their chords
};
/// Measures a graph. By Euler tips + 2 · points − branches = 2 · (components − loops). O(n log n).
NetworkFigures network_figures(const AttributeGraph& graph);

/// Numbers of events that led to a frame.
struct NetworkChanges {
  std::uint32_t births = 0, deaths = 0, unions = 0, separations = 0;
};
/// Counts the events of each frame, of any probability. The components change by births − deaths − unions +
/// separations. `motion` has its strokes identified. Throws InputError as validate() does. O(n log n).
std::vector<NetworkChanges> network_changes(const MotionGraph& motion);

}  // namespace emberfold::graph
