// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "graph/events/believed_lives.hpp"

namespace emberfold::graph::detail {

/// Returns the strokes that may go on as another one: of lives whose end is not believed, and lives whose
/// beginning is not, as continue_strokes() pairs them.
std::vector<std::pair<SubgraphId, SubgraphId>> possible_gaps(const MotionGraph& motion,
                                                             const std::map<SubgraphId, Life>& lives);

/// Lets a stroke that ends where no event is believed go on as one that begins so: at most 10 frames later,
/// where its motion leads, with half of the smaller one's patches within 8 px of such of the other. They get
/// the name of the first, in `events`, too, and patches in the frames between, which move evenly from the end
/// to the beginning. Outlines of things change their shape too fast to be drawn so, and go on in the next
/// frame only. The pairs with the shortest gaps come first. Vertices are renumbered. O(pairs · patches²).
void continue_strokes(MotionGraph& motion, std::vector<Event>& events,
                      const std::map<SubgraphId, Life>& lives);

}  // namespace emberfold::graph::detail
