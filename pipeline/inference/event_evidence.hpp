// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/inference/change_posterior.hpp"

namespace emberfold::pipeline {

/// Holds an event found in the graphs, and the evidence for it.
struct WeighedEvent {
  graph::Event event;  ///< of probability 1
  mcmc::ChangeEvidence evidence;
};

/// Finds the events of a matched clip and the evidence for each.
/// The patches of an event are followed through the frames around it, 10 on each side, and their strength is
/// measured in each. Events that are unlikely whatever the images show get the lowest factor, unmeasured.
/// `source` is read once, and about 40 frames are held. In the order of graph::trace_stroke_events, the same
/// at any number of threads. Throws core::InputError where the graph's number of frames differs from the
/// clip's; core::Cancelled.
std::vector<WeighedEvent> weigh_events(core::FrameSource& source, const graph::MotionGraph& motion,
                                       const core::Context& context = {});

}  // namespace emberfold::pipeline
