// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/learning/operator_rates.hpp"
#include "mcmc/model/motion_model.hpp"
#include "mcmc/simulation/simulated_strokes.hpp"

namespace emberfold::mcmc {

/// What a clip shows, a frame.
struct EventStatistics {
  std::array<double, kSizeClasses> strokes{};  ///< of each size
  std::array<double, 6> events{};        ///< of each kind: graph::EventType
  double patches = 0;
};

/// Of a matched clip of two frames or more, `events` its stroke events.
EventStatistics event_statistics(const graph::MotionGraph& motion, std::span<const graph::Event> events);

/// Of what the operators' rates are learned from, in a clip of so many patches a frame.
EventStatistics event_statistics(const OperatorCounts& counts, double patches);

/// The likeliest frequencies of events in a clip that goes on for ever, where births, splits and disconnects
/// make as many strokes as deaths, merges and connects take: each is changed by the same share, up or down,
/// which is what Poisson counts say under that condition to first order.
void reconcile_event_rates(EventStatistics& statistics);

namespace detail {

/// Lets patches go on for so many frames, numbered from `first` on, and takes their statistics; its
/// events are read off the graphs, as a clip's are. What was in each cell, a frame, is added to `where`, if
/// given.
EventStatistics simulate_statistics(SimulatedStrokes& strokes, const MotionModel& model, std::uint64_t seed, std::uint32_t first,
                int frames, CellMap* where = nullptr);

/// How many frames of a clip are simulated between two corrections of its rates: 4 to 60, of dense clips
/// fewer.
int frames_per_round(const MotionModel& model, int rounds);

}  // namespace detail

}  // namespace emberfold::mcmc
