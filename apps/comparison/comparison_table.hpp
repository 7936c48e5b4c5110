// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace emberfold::apps {

/// Formats the content of measures.json as a table for the console.
std::string comparison_table(const nlohmann::ordered_json& measures);

}  // namespace emberfold::apps
