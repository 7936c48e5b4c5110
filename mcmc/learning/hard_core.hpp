// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "graph/motion_graph.hpp"
#include "mcmc/model/motion_model.hpp"
#include "mcmc/simulation/simulated_strokes.hpp"

namespace emberfold::mcmc {

/// Returns the hard-core distance of two patches of different strokes, px: it depends on their kinds.
double hard_core_distance(const HardCoreDistances& hard_core, const graph::Patch& a, const graph::Patch& b);

/// Returns the largest hard-core distance of any two kinds, px.
double largest_hard_core_distance(const HardCoreDistances& hard_core);

/// Estimates for each pair of kinds the greatest distance, up to 12 px, at which strokes avoid each other.
/// Within it patches have a neighbour of another stroke a fifth as often as they would at places nearby. 0
/// where too few neighbours are expected to tell. O(patches).
HardCoreDistances estimate_hard_core(const graph::MotionGraph& motion);

namespace detail {

/// Pushes strokes apart that came closer than the hard-core distance, by bending their rest shapes.
/// O(patches).
void enforce_hard_core(SimulatedStrokes& strokes, const MotionModel& model);

}  // namespace detail

}  // namespace emberfold::mcmc
