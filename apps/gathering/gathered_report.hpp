// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace emberfold::apps {

/// Returns one self-contained HTML page. `gathered`: of gathered_json, each run with "link", the address of
/// its own report relative to the page; `table`: the content of table.csv.
std::string make_gathered_report(const std::string& folder, const nlohmann::ordered_json& gathered,
                                 const std::string& table, const nlohmann::ordered_json& summary);

}  // namespace emberfold::apps
