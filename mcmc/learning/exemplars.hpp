// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/learning/curve_tracks.hpp"
#include "mcmc/learning/moments.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::mcmc {

/// How far a patch is from rest.
struct Deviation {
  graph::Point offset;  ///< px
  double gain = 0;      ///< logarithm of its contrast over what its lineages have on average
};

/// Of each patch of each frame how far it is from rest: that of the lineages at it, smoothed along the
/// curves. `travel`: each lineage's travel, less what it drifts.
std::vector<std::vector<Deviation>> deviations(const graph::MotionGraph& motion,
                                               const std::vector<detail::Lineage>& lineages,
                                               const Series& travel);

/// The frame's graph with every patch at rest, its vertices numbered from 0.
graph::AttributeGraph at_rest(const graph::AttributeGraph& graph, std::span<const Deviation> deviation);

/// How the patches of frame `frame` ≥ 1 moved as they came there; of one without a past, as if it had stood.
std::vector<Swing> swings(const graph::MotionGraph& motion, const std::vector<std::vector<Deviation>>& all,
                          std::size_t frame, const CellMap& sway_share);

/// Strokes to be born: of each size a sample, evenly spread over the clip, of all strokes of all frames, so
/// that what is born is like what is there; about `most` in all, of each size as many as its share, and some
/// at least. At rest.
std::vector<Exemplar> sample_exemplars(const graph::MotionGraph& motion,
                                       const std::vector<std::vector<Deviation>>& deviation,
                                       std::size_t most);

/// Nine in ten strokes that were born and died lived for so many frames, at most 8, or more; 0 where fewer
/// than five did. A matcher that takes out what is there for a frame or two leaves its trace here.
double shortest_life(std::span<const graph::Event> events);

/// How many strokes of each size were born, as large as they were half way through their lives.
std::array<double, kSizes> born_sizes(const graph::MotionGraph& motion, std::span<const graph::Event> events);

}  // namespace emberfold::mcmc
