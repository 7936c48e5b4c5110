// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/event_posterior.hpp"

#include <span>

#include "graph/events/kept_identity.hpp"
#include "graph/matching/skipped_patches.hpp"
#include "mcmc/inference/change_posterior.hpp"
#include "mcmc/inference/joint_changes.hpp"
#include "pipeline/inference/event_pairs.hpp"

namespace emberfold::pipeline {

namespace {

/// Returns the probability of each event by itself; strokes and joints have separate shares of true events.
std::vector<double> probabilities_alone(std::span<const WeighedEvent> weighed) {
  std::vector<double> result(weighed.size());
  for (const bool of_stroke : {true, false}) {
    std::vector<std::size_t> which;
    std::vector<mcmc::ChangeEvidence> changes;  // of these
    for (std::size_t k = 0; k < weighed.size(); ++k) {
      if (weighed[k].evidence.of_stroke != of_stroke) continue;
      which.push_back(k);
      changes.push_back(weighed[k].evidence);
    }
    const auto probabilities = mcmc::change_probabilities(changes);
    for (std::size_t k = 0; k < which.size(); ++k) result[which[k]] = probabilities[k];
  }
  return result;
}

}  // namespace

EventProbabilities event_probabilities(std::span<const WeighedEvent> weighed) {
  std::vector<mcmc::ChangeEvidence> changes;
  std::vector<graph::Event> events;
  for (const WeighedEvent& one : weighed) {
    changes.push_back(one.evidence);
    events.push_back(one.event);
  }
  EventProbabilities result;
  result.followed = mcmc::probability_followed(changes);
  auto alone = probabilities_alone(weighed);
  for (double& p : alone) p *= result.followed;
  result.of_event = mcmc::joint_probabilities(alone, brief_pairs(events), rival_pairs(events));
  return result;
}

std::vector<graph::Event> event_posterior(core::FrameSource& source, const ClipReadings& readings,
                                          const core::Context& context) {
  const auto weighed = weigh_events(source, readings, context);
  const auto probabilities = event_probabilities(weighed);
  std::vector<graph::Event> events;
  for (std::size_t k = 0; k < weighed.size(); ++k) {
    events.push_back(weighed[k].event);
    events.back().probability = probabilities.of_event[k];
  }
  if (probabilities.followed < 0.5 && !events.empty())
    context.warn(
        "neighbouring frames are no more alike than frames far apart, so that nothing can be followed from "
        "one to the "
        "next: no event is believed; film faster, or leave out --every");
  graph::sort_events(events);
  return events;
}

void follow_strokes(graph::MotionGraph& motion, std::vector<graph::Event>& all_events,
                    double least_probability) {
  graph::keep_identity(motion, all_events, least_probability);
  graph::link_skipped_patches(motion);
}

}  // namespace emberfold::pipeline
