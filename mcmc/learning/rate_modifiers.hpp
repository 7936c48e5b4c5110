// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::mcmc {

std::size_t since_class(double frames);
std::size_t gap_class(double px);
std::size_t turn_class(double angle);  ///< rad, 0…π

/// Something that happened at a place, px, and when, frame.
struct Happening {
  graph::Point place;
  double frame = 0;
};

/// Frames until `frame` since the latest of them within 16 px of a place; infinite where there was none, 0
/// where it is still to come.
double since(std::span<const Happening> all, graph::Point place, double frame);

/// How what happens depends on what happened before, and unions on the gap: events of each class over those
/// that the other rates alone would have made there, drawn towards 1 as if by one event. `events[i]` are
/// samples[i]'s stroke events; a stroke that was there in the first frame is of unknown age. O(sites · events
/// of 32 frames).
Circumstances estimate_circumstances(std::span<const graph::MotionGraph> samples,
                                     std::span<const std::vector<graph::Event>> events,
                                     const OperatorRates& rates);

}  // namespace emberfold::mcmc
