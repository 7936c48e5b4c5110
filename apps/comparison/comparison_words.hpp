// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace emberfold::apps {

/// Describes measures in sentences.
/// For each model: the measures by which it is the nearest to the source, the farthest, and as near as the
/// source's own halves to each other; where the hybrid wins and loses against the linear dynamic texture;
/// which model predicts best; whose strokes change as often as the source's. For two clips: the measures in
/// which they differ.
std::vector<std::string> comparison_words(const nlohmann::ordered_json& measures);

/// Returns whether a distance is hardly above the noise floor: by a quarter and `rounding` at most.
bool at_floor(double distance, double floor);

}  // namespace emberfold::apps
