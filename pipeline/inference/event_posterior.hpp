// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/sampler/change_field.hpp"
#include "mcmc/sampler/sampler_run.hpp"

namespace emberfold::pipeline {

/// Finds the events of a matched clip, each with the probability that the images give it alone, where the
/// usual share of events is true (weigh_events, mcmc::change_log_odds). Sorted as by graph::sort_events. The
/// same bytes at any number of threads. Throws as weigh_events does.
std::vector<graph::Event> weighed_events(core::FrameSource& source, const graph::MotionGraph& motion,
                                         const core::Context& context = {});

/// Returns what may have happened in a matched clip, whose strokes are identified: its strands are the
/// strokes, its changes `events`, in their order. `with_rate`: so many events, the first ones, are as likely
/// as others about them are true. `cuts`: of FirstLook.
mcmc::ChangeField change_field(const graph::MotionGraph& motion, std::span<const graph::Event> events,
                               std::size_t with_rate, std::span<const int> cuts);

/// Gives events the probabilities of mcmc::sample_changes(), which hold their strokes against each other.
/// Arguments as of change_field().
mcmc::SamplerRun sample_events(const graph::MotionGraph& motion, std::vector<graph::Event>& events,
                               std::size_t with_rate, std::span<const int> cuts, std::uint64_t seed,
                               const core::Context& context = {});

/// Makes the graph of a matched clip agree with its weighed events: it changes where events of this
/// probability or more do (graph::keep_believed), and skipped patches are linked
/// (graph::link_skipped_patches). `cuts`: of FirstLook.
void settle_graph(graph::MotionGraph& motion, std::vector<graph::Event>& all_events,
                  std::span<const int> cuts, double least_probability);

}  // namespace emberfold::pipeline
