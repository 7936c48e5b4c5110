// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <nlohmann/json_fwd.hpp>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"

// What the report's page draws, as JSON of bounded size. Positions are rounded to what a screen shows.
namespace emberfold::apps {

/// Columns frame, type (index into all_event_types), x, y, probability, before, after; every `every`-th event
/// where all would be too many. `total` counts all.
nlohmann::ordered_json report_events(std::span<const graph::Event> events);

/// Strokes and patches of each frame and events of each class; means over `step` frames where there are many.
nlohmann::ordered_json report_series(const graph::MotionGraph& motion, std::span<const graph::Event> events);

/// Paths through time [first frame, x, y, x, y, …], those that go farthest and those that live longest in
/// turn: the middle of each stroke, and single patches.
nlohmann::ordered_json report_stroke_paths(const graph::MotionGraph& motion);
nlohmann::ordered_json report_patch_paths(const graph::MotionGraph& motion);

/// For each of `frames` its curves [colour, x, y, x, y, …], simplified.
nlohmann::ordered_json report_curves(const graph::MotionGraph& motion, std::span<const int> frames);

}  // namespace emberfold::apps
