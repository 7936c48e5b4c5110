// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "graph/io/unit_tables.hpp"
#include "graph/network/network_figures.hpp"

namespace emberfold::graph {

/// Writes network.csv, a row for each frame: frame, length, components, longest, points, tips, junctions_3,
/// junctions_4, junctions_more, branches, loops (NetworkFigures), meshes (how many), mesh_mean, mesh_median
/// (px²), tortuosity, births, deaths, unions, separations (NetworkChanges), and where the units are known
/// time_s, length_um, longest_um, mesh_mean_um2, mesh_median_um2. Throws IoError if the stream fails,
/// InputError as validate() does. O(n log n).
void write_network(std::ostream& out, const MotionGraph& motion, const Units& units);

}  // namespace emberfold::graph
