// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

/// Builds the graph and names its patches by their degree and the angles between their edges.
/// This is the part of θ_img that is indexed by degree.
/// - 0: by the profile: ridge, valley, bar (a line with a visible core, 3 blurs wide or more), step.
/// - 1: terminator.
/// - 2: corner, where they bend by more than 60°, else by the profile.
/// - 3: T junction, where two are within 30° of a straight line; L junction, where all lie within less than
///   150° (two and one between them); else Y junction.
/// - 4 and more: crossing.
graph::AttributeGraph name_patch_types(std::vector<graph::Vertex> vertices, std::vector<graph::Edge> edges);

}  // namespace emberfold::sketch
