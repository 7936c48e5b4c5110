// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include <nlohmann/json_fwd.hpp>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"

// Writes the data of the report's page as JSON of bounded size, with positions rounded to a tenth of a pixel.
namespace emberfold::apps {

/// Maximum number of points of a plot over time; longer clips are thinned.
inline constexpr std::size_t kSeries = 1500;

/// Lists events as columns: frame, type (index into all_event_types), x, y, probability, before, after. Too
/// long lists keep every `every`-th event; `total` counts all.
nlohmann::ordered_json report_events(std::span<const graph::Event> events);

/// Counts strokes and patches of each frame and events of each class; long clips as means over `step` frames.
nlohmann::ordered_json report_series(const graph::MotionGraph& motion, std::span<const graph::Event> events);

/// Lists paths [first frame, x, y, x, y, …] of the centres of strokes, and of single patches; alternately
/// those with the greatest extent and those with the longest life.
nlohmann::ordered_json report_stroke_paths(const graph::MotionGraph& motion);
nlohmann::ordered_json report_patch_paths(const graph::MotionGraph& motion);

/// Lists the simplified curves [colour, x, y, x, y, …] of each frame in `frames`.
nlohmann::ordered_json report_curves(const graph::MotionGraph& motion, std::span<const int> frames);

}  // namespace emberfold::apps
