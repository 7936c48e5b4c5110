// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/learning/clip_statistics.hpp"
#include "mcmc/model/motion_model.hpp"
#include "mcmc/simulation/simulated_strokes.hpp"

namespace emberfold::mcmc {

/// Computes the statistics of a matched clip of two frames or more; `events` are its stroke events.
EventStatistics event_statistics(const graph::MotionGraph& motion, std::span<const graph::Event> events);

/// Computes the statistics from the counts of operators, in a clip of so many patches a frame.
EventStatistics event_statistics(const OperatorCounts& counts, double patches);

/// Adjusts event frequencies so that the number of strokes stays constant.
/// Births, splits and disconnects then make as many strokes as deaths, merges and connects remove. Each
/// frequency changes by one common share, up or down: the maximum of the Poisson likelihood under that
/// condition, to first order.
void reconcile_event_rates(EventStatistics& statistics);

namespace detail {

/// Simulates so many frames, numbered from `first`, and returns their statistics.
/// Events are found from the graphs as in a clip. Mean numbers of patches in each cell are added to `where`,
/// if given.
EventStatistics simulate_statistics(SimulatedStrokes& strokes, const MotionModel& model, std::uint64_t seed,
                                    std::uint32_t first, int frames, CellMap* where = nullptr);

/// Returns how many frames are simulated between two corrections of rates: 4…60, fewer for dense clips.
int frames_per_round(const MotionModel& model, int rounds);

}  // namespace detail

}  // namespace emberfold::mcmc
