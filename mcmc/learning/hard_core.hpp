// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "graph/motion_graph.hpp"
#include "mcmc/model/motion_model.hpp"
#include "mcmc/simulation/simulated_strokes.hpp"

// Strokes of a frame do not run into each other: two ridges have a valley between them.
namespace emberfold::mcmc {

/// px that patches of two strokes keep between them.
double kept_apart(const Exclusion& exclusion, const graph::Patch& a, const graph::Patch& b);

/// The most that patches of any kind do.
double most_kept_apart(const Exclusion& exclusion);

/// For each kind of pair the greatest distance, up to 12 px, within which patches have one of another stroke
/// a fifth as often as they would had they been set down elsewhere nearby; 0 where so few would that nothing
/// can be said. O(patches).
Exclusion estimate_exclusion(std::span<const graph::MotionGraph> samples);

namespace detail {

/// Strokes that have come nearer to each other than the model's strokes do make way: their rest shapes bend.
void keep_apart(Particles& particles, const MotionModel& model);

}  // namespace detail

}  // namespace emberfold::mcmc
