// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/event_posterior.hpp"

#include "graph/events/believed_graph.hpp"
#include "graph/matching/skipped_patches.hpp"
#include "mcmc/inference/change_posterior.hpp"
#include "pipeline/inference/event_evidence.hpp"

namespace emberfold::pipeline {

std::vector<graph::Event> event_posterior(core::FrameSource& source, const graph::MotionGraph& motion,
                                          const core::Context& context) {
  const auto weighed = weigh_events(source, motion, context);
  std::vector<mcmc::ChangeEvidence> evidence;
  for (const WeighedEvent& one : weighed) evidence.push_back(one.evidence);
  const auto probabilities = mcmc::change_probabilities(evidence);
  std::vector<graph::Event> events;
  for (std::size_t k = 0; k < weighed.size(); ++k) {
    events.push_back(weighed[k].event);
    events.back().probability = probabilities[k];
  }
  graph::sort_events(events);
  return events;
}

void settle_graph(graph::MotionGraph& motion, std::vector<graph::Event>& all_events,
                  std::span<const int> cuts, double least_probability) {
  graph::keep_believed(motion, all_events, cuts, least_probability);
  graph::link_skipped_patches(motion);
}

}  // namespace emberfold::pipeline
