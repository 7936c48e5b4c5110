// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "graph/events/events.hpp"
#include "graph/io/unit_tables.hpp"
#include "graph/io/units.hpp"
#include "graph/motion_graph.hpp"

// Rates of events and lives of strokes, in frames and pixels and, where a clip's units are known, in seconds
// and lengths.
namespace emberfold::apps {

/// Returns {"level", "counted_in": {"frames", "s", "s_mm2", "s_mm"} (gaps between frames; seconds times area
/// and times length of stroke), "classes": {class and "all": {"count", "a_frame", "a_second",
/// "a_second_and_mm2", "a_second_and_mm_of_stroke"}}}: each a mean with an exact 90 % interval, null where a
/// unit is unknown. `share`: of the frame in which structure counts.
nlohmann::ordered_json event_rates_json(const std::vector<graph::Event>& events,
                                        const graph::MotionGraph& motion, const graph::Units& units,
                                        double share);

/// Returns {"life", "length", "growth", "speed"}: each {"unit", "median", "low", "high", "strokes"}, in
/// frames and px, with 5 % of the strokes below low and 5 % above high, and "median_s" (or "median_um",
/// "median_um_s") and so on where units are known. Lives are of strokes that are born and die in the clip.
nlohmann::ordered_json lives_json(const std::vector<graph::StrokeLife>& lives, const graph::Units& units);

/// Compares the rates of two clips, by class and for all events: {"level", "classes": {class: {"ratio",
/// "low", "high", "p", "counts"}}}; the ratio is that of b to a, null where it is not finite. Exposures are
/// in frames, or in any common unit.
nlohmann::ordered_json rate_tests_json(const std::vector<double>& counts_a, double exposure_a,
                                       const std::vector<double>& counts_b, double exposure_b);

}  // namespace emberfold::apps
