// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::pipeline {

/// Finds the events of a matched clip, each with the probability that the clip shows it.
/// The patches that an event is about are followed through the frames around it, 10 to each side, and it is
/// measured how strongly they show in each; the probability is that of a change there rather than none
/// (mcmc::log_change_factor, mcmc::change_probabilities; docs/method/events.md). `readings`: motion graphs of
/// the clip, at least one, matched forwards and backwards for instance. An event that only some of them have
/// is held to be less likely (6 nats); those of other readings than the first name no strokes. `source` is
/// read once, and some 40 frames are held. Sorted as by graph::sort_events. The same bytes at any number of
/// threads. Throws core::InputError for no reading or one of another number of frames than the clip,
/// core::Cancelled.
std::vector<graph::Event> event_posterior(core::FrameSource& source,
                                          std::span<const graph::MotionGraph> readings,
                                          const core::Context& context = {});

}  // namespace emberfold::pipeline
