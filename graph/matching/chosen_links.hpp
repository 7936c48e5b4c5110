// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "graph/motion_graph.hpp"

namespace emberfold::graph::detail {

/// Chooses between two sets of links of the same two frames, for each group of strokes that either set ties
/// together: the set with fewer changes of strokes, then the one with more links, then the one with the
/// shorter links. Both sets are sorted star forests of strokes, and so is the result. Does not depend on the
/// order of the sets or of the frames. O(n log n).
std::vector<Link> choose_links(const AttributeGraph& before, const AttributeGraph& after,
                               const std::vector<Link>& one, const std::vector<Link>& other);

}  // namespace emberfold::graph::detail
