// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

/// Removes curves that are the flanks of others, since a stroke and its shaded sides are one thing.
/// A curve is removed where for two patches in five or more a line runs along with it at the edge of the
/// patch's core (of a step: three blurs), within 3 px. That line is one of two kinds:
/// - of the opposite sign, at most 0.7 times as wide, and not much fainter: soft shading beside a line looks
/// like a wide line of the other sign;
/// - or of either sign, where the curve is a step that saves less than the line, because the line's sides
/// differ, and the line has at least `of_step` times the step's contrast.
/// The lines beside a removed curve stay. Patches carry their gain; those left keep their ids and get their
/// types anew. O(patches).
graph::AttributeGraph remove_flank_curves(const graph::AttributeGraph& graph, double of_step);

}  // namespace emberfold::sketch
