// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/events/events.hpp"
#include "mcmc/inference/change_posterior.hpp"
#include "pipeline/inference/clip_readings.hpp"

namespace emberfold::pipeline {

/// Holds an event that was read from the graphs, and what speaks for it.
struct WeighedEvent {
  graph::Event event;  ///< of probability 1; names the strokes of the first of the steadied readings
  mcmc::ChangeEvidence evidence;
};

/// Finds the events of all readings of a clip and what speaks for each.
/// The patches that an event is about are followed through the frames around it, 10 to each side, and it is
/// measured how strongly they show in each. Events of two readings are one if they are of one family, at most
/// 2 frames and 10 px apart; measured are the steadied ones that have it, if any, and their mean counts: once
/// the others cannot make the event likely any more they are not measured. Events that are unlikely whatever
/// the images show have the least factor, unmeasured. `source` is read once, and some 40 frames are held. In
/// no particular order, the same at any number of threads. Throws core::InputError for no steadied reading,
/// and for one of another number of frames than the clip; core::Cancelled.
std::vector<WeighedEvent> weigh_events(core::FrameSource& source, const ClipReadings& readings,
                                       const core::Context& context = {});

}  // namespace emberfold::pipeline
