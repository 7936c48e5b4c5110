// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/events/events.hpp"
#include "mcmc/inference/change_posterior.hpp"
#include "pipeline/inference/clip_readings.hpp"

namespace emberfold::pipeline {

/// Holds an event found in the graphs, and the evidence for it.
struct WeighedEvent {
  graph::Event event;  ///< of probability 1; names strokes of the first `steadied` interpretation
  mcmc::ChangeEvidence evidence;
};

/// Finds the events of all interpretations of a clip and the evidence for each.
/// The patches of an event are followed through the frames around it, 10 on each side, and their strength is
/// measured in each. Events of two interpretations are one if they are of one family, at most 2 frames and 10
/// px apart. An event is measured in the `steadied` interpretations that have it, if any, and their mean
/// counts; measuring stops once the rest cannot make the event likely. Events that are unlikely whatever the
/// images show get the lowest factor, unmeasured. `source` is read once, and about 40 frames are held. In no
/// particular order, the same at any number of threads. Throws core::InputError without `steadied`
/// interpretations, and for one whose number of frames differs from the clip's; core::Cancelled.
std::vector<WeighedEvent> weigh_events(core::FrameSource& source, const ClipReadings& readings,
                                       const core::Context& context = {});

}  // namespace emberfold::pipeline
