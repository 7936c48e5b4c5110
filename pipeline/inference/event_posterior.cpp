// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/event_posterior.hpp"

#include <span>

#include "graph/events/kept_identity.hpp"
#include "graph/matching/skipped_patches.hpp"
#include "mcmc/inference/change_posterior.hpp"

namespace emberfold::pipeline {

std::vector<graph::Event> event_posterior(core::FrameSource& source, const ClipReadings& readings,
                                          const core::Context& context) {
  const auto weighed = weigh_events(source, readings, context);
  std::vector<graph::Event> events;
  std::vector<mcmc::ChangeEvidence> changes;  // of the events
  for (const bool of_stroke : {true, false}) {
    const std::size_t first = events.size();
    for (const WeighedEvent& one : weighed) {
      if (one.evidence.of_stroke != of_stroke) continue;
      events.push_back(one.event);
      changes.push_back(one.evidence);
    }
    const auto probabilities = mcmc::change_probabilities(std::span(changes).subspan(first));
    for (std::size_t k = 0; k < probabilities.size(); ++k) events[first + k].probability = probabilities[k];
  }
  const double followed = mcmc::probability_followed(changes);
  for (graph::Event& event : events) event.probability *= followed;
  if (followed < 0.5 && !events.empty())
    context.warn(
        "neighbouring frames are no more alike than frames far apart, so that nothing can be followed from "
        "one to the "
        "next: no event is believed; film faster, or leave out --every");
  graph::sort_events(events);
  return events;
}

void follow_strokes(graph::MotionGraph& motion, std::vector<graph::Event>& all_events) {
  graph::keep_identity(motion, all_events, kLikely);
  graph::link_skipped_patches(motion);
}

}  // namespace emberfold::pipeline
