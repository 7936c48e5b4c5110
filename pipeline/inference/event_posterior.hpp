// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/events/events.hpp"
#include "pipeline/inference/event_evidence.hpp"

namespace emberfold::pipeline {

inline constexpr double kLikely = 0.5;  ///< least probability of reported events, by default

/// Holds the probabilities of weighed events.
struct EventProbabilities {
  std::vector<double> of_event;  ///< by event
  double followed = 1;           ///< mcmc::probability_followed(): it conditions all probabilities
};

/// Computes the probabilities of a clip's events from the evidence for each.
/// Events of strokes and of joints have their own shares of true events (mcmc::change_probabilities). Events
/// that depend on each other are weighed together (brief_pairs, rival_pairs, mcmc::joint_probabilities). See
/// docs/method/events.md. O(events).
EventProbabilities event_probabilities(std::span<const WeighedEvent> weighed);

/// Finds the events of a matched clip, each with the probability that the clip shows it.
/// They are weighed (weigh_events), and sorted as by graph::sort_events. The same bytes at any number
/// of threads. Throws as weigh_events does.
std::vector<graph::Event> event_posterior(core::FrameSource& source, const ClipReadings& readings,
                                          const core::Context& context = {});

/// Makes the strokes of a matched clip agree with its weighed events: they keep their identity through all
/// events of less than this probability (graph::keep_identity), and skipped patches are linked
/// (graph::link_skipped_patches).
void follow_strokes(graph::MotionGraph& motion, std::vector<graph::Event>& all_events,
                    double least_probability = kLikely);

}  // namespace emberfold::pipeline
