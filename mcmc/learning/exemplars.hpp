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

/// Estimates for each patch of each frame the logarithm of its contrast over the mean of the tracks at it,
/// smoothed along the curves, −1 to 1. O(samples + vertices).
std::vector<std::vector<double>> contrast_deviations(const graph::MotionGraph& motion,
                                                     const std::vector<detail::CurveTrack>& tracks);

/// Returns the frame's graph with the mean contrast of every patch's tracks, its vertices numbered from 0.
graph::AttributeGraph with_usual_contrast(const graph::AttributeGraph& graph,
                                          std::span<const double> deviation);

/// Samples the strokes that a model can give birth to, with their usual contrast and in the shape that they
/// were seen in.
/// From each size class it takes strokes evenly over the clip, in proportion to its share of all strokes of
/// all frames but at least some; about `most` in all. Newborn strokes then look like the strokes of the clip.
std::vector<Exemplar> sample_exemplars(const graph::MotionGraph& motion,
                                       const std::vector<std::vector<double>>& deviation, std::size_t most);

/// Estimates the refractory period: the lifetime, at most 8 frames, that nine in ten strokes reached.
/// Only strokes that were born and died in the clip count; 0 for fewer than five. Flicker removal in the
/// matcher erases lives of a frame or two, which shows here.
double estimate_refractory_period(std::span<const graph::Event> events);

/// Counts the births of each size class; a stroke's size is the one half way through its life.
std::array<double, kSizeClasses> count_births_by_size(const graph::MotionGraph& motion,
                                                      std::span<const graph::Event> events);

}  // namespace emberfold::mcmc
