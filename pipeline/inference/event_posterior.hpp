// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::pipeline {

/// Finds the events of a matched clip, each with the probability that the clip shows it.
/// The patches that an event is about are followed through the frames around it, 10 to each side, and it is
/// measured how strongly they show in each; the probability is that of a change there rather than none
/// (mcmc::log_change_factor, mcmc::change_probabilities; docs/method/events.md). `source`: the clip of
/// `motion`; it is read once, and some 40 frames are held. Sorted as by graph::sort_events. The same bytes at
/// any number of threads. Throws core::InputError for a clip of another length, core::Cancelled.
std::vector<graph::Event> event_posterior(core::FrameSource& source, const graph::MotionGraph& motion,
                                          const core::Context& context = {});

}  // namespace emberfold::pipeline
