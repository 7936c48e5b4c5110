// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "graph/io/units.hpp"

namespace emberfold::graph {

/// Adds to the JSON object of a clip what its rate and pixel size do not say: `times_s`, of frames that are
/// not evenly spaced, and `counted_from`, of a part of a clip.
void add_units(nlohmann::ordered_json& clip, const Units& units);
/// Reads the units of such an object (`fps`, `fps_is_known`, `pixel_um`). Throws nlohmann::json::exception.
Units read_units(const nlohmann::json& clip);

}  // namespace emberfold::graph
