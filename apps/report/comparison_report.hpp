// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "apps/comparison/comparison.hpp"

namespace emberfold::apps {

/// Returns one self-contained HTML page: the measures in words, moments of all clips, tables of distances,
/// prediction and strokes, plots. `summary` as in summary.json.
std::string make_comparison_report(const Comparison& comparison, const nlohmann::ordered_json& summary);

}  // namespace emberfold::apps
