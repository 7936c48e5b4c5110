// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/events/events.hpp"
#include "pipeline/inference/event_evidence.hpp"

namespace emberfold::pipeline {

inline constexpr double kLikely = 0.5;  ///< least probability of events that are reported

/// Finds the events of a matched clip, each with the probability that the clip shows it.
/// What speaks for each (weigh_events) is combined by mcmc::change_probabilities, for events of strokes
/// and of joints apart (docs/method/events.md). Sorted as by graph::sort_events. The
/// same bytes at any number of threads. Throws as weigh_events does.
std::vector<graph::Event> event_posterior(core::FrameSource& source, const ClipReadings& readings,
                                          const core::Context& context = {});

/// Lets the strokes of a matched clip follow its weighed events: they keep their identity through all that is
/// not likely (graph::keep_identity), and skipped patches are linked (graph::link_skipped_patches).
void follow_strokes(graph::MotionGraph& motion, std::vector<graph::Event>& all_events);

}  // namespace emberfold::pipeline
