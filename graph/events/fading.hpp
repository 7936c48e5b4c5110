// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "graph/motion_graph.hpp"

namespace emberfold::graph::detail {

/// Returns which patches of a frame are there in the next one, too (`ahead`), or were in the one before.
/// Beyond the clip's ends all are, and so is one alone among patches that are: where a curve is cut into
/// patches anew their number varies by one.
std::vector<bool> staying_patches(const MotionGraph& motion, std::size_t frame, bool ahead);

/// Marks, too, the patches that stay and from which patches that do not lead to an end of a curve: there a
/// stroke ends once they are gone.
void mark_fading_ends(const AttributeGraph& graph, const std::vector<bool>& stays,
                      std::vector<bool>& near_end);

}  // namespace emberfold::graph::detail
