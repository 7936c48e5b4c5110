// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/learning/event_history.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::mcmc::detail {

/// Expected number of events of a class in a gap at no site of the model, where it has none.
constexpr double kElsewhere = 1e-3;

/// Returns the log probability of a gap's events, and of no others, by graph::EventType.
/// `before`, `after`: the graphs, strokes identified. `events`: those of frame `frame`. `history`: of the
/// frames before. O(sites · events).
std::array<double, 6> event_log_probabilities(const MotionModel& model, const graph::AttributeGraph& before,
                                              const graph::AttributeGraph& after,
                                              std::span<const graph::Event> events,
                                              const EventHistory& history, int frame);

}  // namespace emberfold::mcmc::detail
