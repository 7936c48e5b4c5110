// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "apps/gathering/gathered_runs.hpp"
#include "apps/gathering/group_statistics.hpp"

namespace emberfold::apps {

/// Writes table.csv: a line for each run and type of event, and for each group and type.
void write_gathered_table(std::ostream& out, const GatheredRuns& gathered, const GroupStatistics& statistics);

/// Returns the same, and the tests between groups, as JSON.
nlohmann::ordered_json gathered_json(const GatheredRuns& gathered, const GroupStatistics& statistics);

/// Describes the results in sentences, the most important first.
std::vector<std::string> gathered_words(const GatheredRuns& gathered, const GroupStatistics& statistics);

}  // namespace emberfold::apps
