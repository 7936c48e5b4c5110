// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace emberfold::apps {

/// Describes measures in sentences.
/// For each model: the measures by which it is closest to the source, farthest from it, and within the noise
/// floor; which model predicts best; whose strokes change at the source's rates. For two clips: the measures
/// in which they differ.
std::vector<std::string> comparison_words(const nlohmann::ordered_json& measures);

/// Returns whether a distance is hardly above the noise floor: by at most a quarter, plus `rounding`.
bool at_floor(double distance, double floor);

}  // namespace emberfold::apps
