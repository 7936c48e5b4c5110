// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

/// Drops the curves that are the flanks of others: a stroke and what its sides look like are one thing. For
/// two patches in five of a curve or more, a line runs along with it at the edge of the patch's core (of a
/// step: three blurs), give or take 3 px,
/// - of the opposite sign, at most 0.7 times as wide, and not much fainter: between a line and soft shading
///   of the ground lies what looks like a wide line of the other sign;
/// - or of either sign, where the curve is a step that saves less than the line: the line's sides differ.
/// The lines beside a dropped curve stay. Patches carry their gain; those left keep their ids and are named
/// by their degree. O(patches).
graph::AttributeGraph remove_flank_curves(const graph::AttributeGraph& graph);

}  // namespace emberfold::sketch
