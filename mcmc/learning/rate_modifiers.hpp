// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::mcmc {

/// Return the classes of a time, a gap and a turn (mcmc/model/motion_model.hpp).
std::size_t elapsed_class(double frames);
std::size_t gap_class(double px);
std::size_t turn_class(double angle);  ///< rad, 0…π

/// Holds the place, px, and the frame of an event.
struct PastEvent {
  graph::Point place;
  double frame = 0;
};

/// Returns the number of frames until `frame` since the latest event within 16 px of a place.
/// Infinite without any such event; 0 for an event in the future.
double frames_since(std::span<const PastEvent> all, graph::Point place, double frame);

/// Estimates how rates depend on past events, on gaps and on turns.
/// Each factor is the number of events of a class over the number that the other rates predict, shrunk
/// towards 1 with the weight of one event. `events` are the stroke events, in order; strokes of the first
/// frame are of unknown age. O(sites · events of 32 frames).
RateModifiers estimate_rate_modifiers(const graph::MotionGraph& motion, std::span<const graph::Event> events,
                                      const OperatorRates& rates);

}  // namespace emberfold::mcmc
