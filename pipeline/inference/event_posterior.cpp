// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/event_posterior.hpp"

#include "mcmc/inference/change_posterior.hpp"

namespace emberfold::pipeline {

std::vector<graph::Event> event_posterior(core::FrameSource& source, const ClipReadings& readings,
                                          const core::Context& context) {
  const auto weighed = weigh_events(source, readings, context);
  std::vector<graph::Event> events;
  for (const bool of_stroke : {true, false}) {
    std::vector<mcmc::ChangeEvidence> changes;
    const std::size_t first = events.size();
    for (const WeighedEvent& one : weighed) {
      if (one.evidence.of_stroke != of_stroke) continue;
      events.push_back(one.event);
      changes.push_back(one.evidence);
    }
    const auto probabilities = mcmc::change_probabilities(changes);
    for (std::size_t k = 0; k < probabilities.size(); ++k) events[first + k].probability = probabilities[k];
  }
  graph::sort_events(events);
  return events;
}

}  // namespace emberfold::pipeline
