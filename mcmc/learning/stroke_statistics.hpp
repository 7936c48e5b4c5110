// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/learning/clip_statistics.hpp"

namespace emberfold::mcmc {

/// Holds the number of strokes and events of a clip, frame by frame.
struct StrokeSeries {
  /// Events by graph::EventType, in the gap before each frame but the first.
  std::array<std::vector<double>, 6> events;
  std::vector<double> strokes;  ///< in each frame
  std::vector<double> ended;    ///< of these, in their last frame; 0 in the clip's last frame
  std::vector<double> length;   ///< px, sum of the lengths of all edges
};
/// Counts strokes and events; `motion` has its strokes identified, `events` are its events.
/// O(vertices log vertices).
StrokeSeries stroke_series(const graph::MotionGraph& motion, std::span<const graph::Event> events);

/// Estimates the mean of counts that follow each other in time, with a 95 % interval.
/// The interval is that of a Gamma law (Jeffreys' prior). Its variance is that of independent events times
/// the dispersion of blocks of neighbouring frames, widened by Student's quantile for few blocks. `low` is 0
/// for no events. Throws core::InputError for no count.
RateInterval mean_count(std::span<const double> counts);

/// Estimates Σ numerator / Σ denominator of two series of one length, with a 95 % interval.
/// Delta method over blocks of neighbouring frames, on a logarithmic scale. All 0 where either sum is 0;
/// `low` is 0 and `high` infinite for fewer than four blocks. Throws core::InputError for different lengths.
RateInterval mean_ratio(std::span<const double> numerator, std::span<const double> denominator);

/// Computes the statistics. Throws core::InputError for fewer than two frames.
StrokeStatistics stroke_statistics(const StrokeSeries& series);

}  // namespace emberfold::mcmc
