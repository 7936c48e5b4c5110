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

/// Holds the deviation of a patch from its rest.
struct Deviation {
  graph::Point offset;  ///< px
  double gain = 0;      ///< logarithm of its contrast over the mean of its tracks
};

/// Estimates the deviation of each patch of each frame from the tracks at it, smoothed along the curves.
/// `travel`: each track's normal displacement, less its drift. O(samples + vertices).
std::vector<std::vector<Deviation>> patch_deviations(const graph::MotionGraph& motion,
                                                     const std::vector<detail::CurveTrack>& tracks,
                                                     const Series& travel);

/// Returns the frame's graph with every patch at rest, its vertices numbered from 0.
graph::AttributeGraph graph_at_rest(const graph::AttributeGraph& graph, std::span<const Deviation> deviation);

/// Estimates the motion of the patches of frame `frame` ≥ 1; a patch without a predecessor stands still.
std::vector<InitialMotion> estimate_initial_motion(const graph::MotionGraph& motion,
                                                   const std::vector<std::vector<Deviation>>& all,
                                                   std::size_t frame, const CellMap& displacement_scale);

/// Samples the strokes that a model can give birth to, at rest.
/// From each size class it takes strokes evenly over the clip, in proportion to its share of all strokes of
/// all frames but at least some; about `most` in all. Newborn strokes then look like the strokes of the clip.
std::vector<Exemplar> sample_exemplars(const graph::MotionGraph& motion,
                                       const std::vector<std::vector<Deviation>>& deviation,
                                       std::size_t most);

/// Estimates the refractory period: the lifetime, at most 8 frames, that nine in ten strokes reached.
/// Only strokes that were born and died in the clip count; 0 for fewer than five. Flicker removal in the
/// matcher erases lives of a frame or two, which shows here.
double estimate_refractory_period(std::span<const graph::Event> events);

/// Counts the births of each size class; a stroke's size is the one half way through its life.
std::array<double, kSizeClasses> count_births_by_size(const graph::MotionGraph& motion,
                                                      std::span<const graph::Event> events);

}  // namespace emberfold::mcmc
