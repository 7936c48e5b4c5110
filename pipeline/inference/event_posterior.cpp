// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/event_posterior.hpp"

#include <algorithm>
#include <cstdlib>

#include "graph/events/believed_graph.hpp"
#include "graph/events/event_family.hpp"
#include "graph/matching/skipped_patches.hpp"
#include "mcmc/inference/change_posterior.hpp"
#include "pipeline/inference/event_evidence.hpp"

namespace emberfold::pipeline {

namespace {

constexpr int kSameFrames = 2;     // between one event in two samples
constexpr double kSamePlace = 10;  // px

}  // namespace

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

void weigh_by_samples(std::span<const graph::MotionGraph> samples, std::vector<graph::Event>& events) {
  std::vector<int> times(events.size(), 0);
  for (const graph::MotionGraph& sample : samples) {
    const auto drawn = graph::stroke_events(sample);
    for (std::size_t k = 0; k < events.size(); ++k)
      times[k] += std::ranges::any_of(drawn, [&](const graph::Event& one) {
        return graph::detail::family(one.type) == graph::detail::family(events[k].type) &&
               std::abs(one.frame - events[k].frame) <= kSameFrames &&
               distance(one.position, events[k].position) <= kSamePlace;
      });
  }
  for (std::size_t k = 0; k < events.size(); ++k)
    events[k].probability *= static_cast<double>(times[k]) / static_cast<double>(samples.size());
}

void settle_graph(graph::MotionGraph& motion, std::vector<graph::Event>& all_events,
                  std::span<const int> cuts, double least_probability) {
  graph::keep_believed(motion, all_events, cuts, least_probability);
  graph::link_skipped_patches(motion);
}

}  // namespace emberfold::pipeline
