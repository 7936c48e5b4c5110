// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/event_posterior.hpp"

#include <map>

#include "core/math/log_odds.hpp"
#include "graph/events/believed_graph.hpp"
#include "graph/events/believed_lives.hpp"
#include "graph/events/continued_strokes.hpp"
#include "graph/matching/skipped_patches.hpp"
#include "mcmc/inference/change_posterior.hpp"
#include "mcmc/sampler/sample_changes.hpp"
#include "pipeline/inference/event_evidence.hpp"

namespace emberfold::pipeline {

namespace {

using graph::EventType;
using graph::SubgraphId;

constexpr double kNever = -12;  // log odds

/// Returns whether a birth or death is that of a stroke that comes in or goes out with the picture.
bool is_crossing(const graph::Event& event, const std::map<SubgraphId, graph::detail::Life>& lives) {
  return (event.type == EventType::birth && lives.at(event.after[0]).comes_in) ||
         (event.type == EventType::death && lives.at(event.before[0]).goes_out);
}

/// Adds the gaps between strokes that die and strokes that are born; of `lives` only these are left open.
void add_gaps(const graph::MotionGraph& motion, std::map<SubgraphId, graph::detail::Life>& lives,
              mcmc::ChangeField& field, std::span<const graph::Event> events) {
  std::map<SubgraphId, std::uint32_t> births, deaths;
  for (std::uint32_t k = 0; k < events.size(); ++k) {
    if (events[k].type == EventType::birth) births[events[k].after[0]] = k;
    if (events[k].type == EventType::death) deaths[events[k].before[0]] = k;
  }
  for (auto& [stroke, life] : lives)
    life.begins = !births.contains(stroke), life.ends = !deaths.contains(stroke);
  for (const auto& [from, to] : graph::detail::possible_gaps(motion, lives))
    field.gaps.push_back({deaths.at(from), births.at(to)});
}

}  // namespace

std::vector<graph::Event> weighed_events(core::FrameSource& source, const graph::MotionGraph& motion,
                                         const core::Context& context) {
  std::vector<graph::Event> events;
  for (const WeighedEvent& weighed : weigh_events(source, motion, context)) {
    events.push_back(weighed.event);
    events.back().probability = core::from_log_odds(mcmc::change_log_odds(weighed.evidence));
  }
  graph::sort_events(events);
  return events;
}

mcmc::ChangeField change_field(const graph::MotionGraph& motion, std::span<const graph::Event> events,
                               std::size_t with_rate, std::span<const int> cuts) {
  const graph::detail::Believed none(motion.sketch.frames.size() + 1);
  auto lives = graph::detail::believed_lives(motion, none, cuts);
  mcmc::ChangeField field;
  std::map<SubgraphId, std::uint32_t> strand_of;
  for (const auto& [stroke, life] : lives) {
    strand_of[stroke] = static_cast<std::uint32_t>(field.strands.size());
    field.strands.push_back({static_cast<int>(life.first), static_cast<int>(life.last), life.comes_in,
                             life.goes_out, life.patches, life.closed});
  }
  for (const graph::Event& event : events) {
    mcmc::Change change{event.type,
                        event.frame,
                        event.position,
                        core::log_odds(event.probability),
                        field.changes.size() < with_rate,
                        {},
                        {}};
    for (const SubgraphId stroke : event.before) change.before.push_back(strand_of.at(stroke));
    for (const SubgraphId stroke : event.after) change.after.push_back(strand_of.at(stroke));
    if (is_crossing(event, lives)) change.log_odds = kNever;
    field.changes.push_back(std::move(change));
  }
  add_gaps(motion, lives, field, events);
  return field;
}

mcmc::SamplerRun sample_events(const graph::MotionGraph& motion, std::vector<graph::Event>& events,
                               std::size_t with_rate, std::span<const int> cuts, std::uint64_t seed,
                               const core::Context& context) {
  auto sampled = mcmc::sample_changes(change_field(motion, events, with_rate, cuts), seed, context);
  for (std::size_t k = 0; k < events.size(); ++k) events[k].probability = sampled.probabilities[k];
  return std::move(sampled.run);
}

void settle_graph(graph::MotionGraph& motion, std::vector<graph::Event>& all_events,
                  std::span<const int> cuts, double least_probability) {
  graph::keep_believed(motion, all_events, cuts, least_probability);
  graph::link_skipped_patches(motion);
}

}  // namespace emberfold::pipeline
