// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace emberfold::apps {

/// What the measures say, in sentences: of each model in what it is the nearest to the source, the farthest,
/// and as near as the source's own halves to each other; where the hybrid wins and loses against the linear
/// dynamic texture; who foretells best; whose strokes change as often as the source's. Of two clips: what
/// tells them apart.
std::vector<std::string> comparison_words(const nlohmann::ordered_json& measures);

/// Whether a distance is hardly more than the noise floor's: at most a quarter and `rounding` above it.
bool at_floor(double distance, double floor);

}  // namespace emberfold::apps
