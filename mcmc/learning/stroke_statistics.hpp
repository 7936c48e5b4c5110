// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/learning/operator_rates.hpp"

namespace emberfold::mcmc {

/// What happens to the strokes of a clip, frame by frame.
struct StrokeSeries {
  /// By graph::EventType: events in the gap before each frame but the first.
  std::array<std::vector<double>, 6> events;
  std::vector<double> strokes;  ///< in each frame
  std::vector<double> ended;    ///< of these, whose last frame this is; 0 in the clip's last frame
  std::vector<double> length;   ///< px, of all strokes of the frame together: the sum of their edges
};
/// `motion` has its strokes identified, `events` are its events. O(vertices log).
StrokeSeries stroke_series(const graph::MotionGraph& motion, std::span<const graph::Event> events);

/// The mean of counts that follow each other in time and what it may be: with 95 % probability between `low`
/// and `high`. A Gamma law (Jeffreys' prior) whose variance is as much larger than that of independent
/// events as the counts of blocks of neighbouring frames vary more than theirs would, with Student's heavier
/// tails for how few blocks tell that. `low` is 0 where nothing happened. InputError for no count.
RateInterval mean_count(std::span<const double> counts);

/// Σ numerator / Σ denominator of series of one length, with 95 %: the delta method over blocks of
/// neighbouring frames, on a logarithmic scale. All 0 where either sum is 0; `low` 0 and `high` infinite with
/// fewer than four blocks of something. InputError for unlike lengths.
RateInterval mean_ratio(std::span<const double> numerator, std::span<const double> denominator);

/// How strokes are and what becomes of them, each with 95 %.
struct StrokeStatistics {
  int frames = 0;
  std::array<double, 6> happened{};  ///< by graph::EventType
  std::array<RateInterval, 6> events_a_frame;
  double strokes_a_frame = 0;
  RateInterval lifetime;  ///< frames that a stroke lives: stroke-frames for each that ends, so that those cut
                          ///< by the clip's ends tell what they can
  RateInterval length;    ///< px, of a stroke
};
/// InputError for fewer than two frames.
StrokeStatistics stroke_statistics(const StrokeSeries& series);

}  // namespace emberfold::mcmc
