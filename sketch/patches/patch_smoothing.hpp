// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

/// Moves the patches across their curves to their most likely places. Each was measured with the error that
/// noise of this SD (grey levels) leaves to a profile of its contrast and slope (Cramér and Rao's bound), and
/// curves bend evenly,
///   minimise Σ uᵢ²/σᵢ² + Σ |third difference of the places|²/τ²,
/// uᵢ being how far patch i moves, τ the usual third difference of curves. A strong line stays where it was
/// found; a faint one loses its jitter. Width and blur are evened likewise, by their first differences. Ends
/// of curves at meetings, and corners, do not move. O(patches).
graph::AttributeGraph smooth_patches(const graph::AttributeGraph& graph, double noise);

}  // namespace emberfold::sketch
