// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "graph/io/unit_tables.hpp"
#include "pipeline/review/review_calibration.hpp"

namespace emberfold::apps {

/// Returns the results of a review for summary.json: {"yes", "no", "other", "added", "unmatched", "shift",
/// "slope":
/// {"strokes", "joints"}, "level", "classes": {class and "all": {"count", "a_frame", "a_second"}}}, each of
/// the last three {"mean", "low", "high"}, a_second null where the frame rate is unknown.
nlohmann::ordered_json review_json(const pipeline::ReviewedClip& reviewed, const graph::Units& units);

}  // namespace emberfold::apps
