// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::pipeline {

inline constexpr double kLikely = 0.5;  ///< least probability of reported events, by default

/// Finds the events of a matched clip, each with the probability that the clip shows it.
/// They are weighed (weigh_events, mcmc::change_probabilities, docs/method/events.md) and sorted as by
/// graph::sort_events. The same bytes at any number of threads. Throws as weigh_events does.
std::vector<graph::Event> event_posterior(core::FrameSource& source, const graph::MotionGraph& motion,
                                          const core::Context& context = {});

/// Makes the graph of a matched clip agree with its weighed events: it changes where events of this
/// probability or more do (graph::keep_believed), and skipped patches are linked
/// (graph::link_skipped_patches). `cuts`: of find_cuts.
void settle_graph(graph::MotionGraph& motion, std::vector<graph::Event>& all_events,
                  std::span<const int> cuts, double least_probability);

}  // namespace emberfold::pipeline
