// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "apps/commands/analysis.hpp"
#include "pipeline/stages/analysis_stages.hpp"

// A run is a folder that can be resumed: analyze stores the results of each stage in it.
namespace emberfold::apps {

/// Hashes of everything that each stage of a run depends on.
struct RunKeys {
  pipeline::StageKeys stages;
  std::string run;  ///< of everything, including pictures and report
};

/// Returns the keys of an analysis; nothing for a clip that cannot be identified, a pipe. `review`: the file
/// of reviewed events, or empty.
std::optional<RunKeys> run_keys(const std::string& clip, const std::string& review,
                                const AnalyzeOptions& options, std::uint64_t seed);

/// Returns whether the folder holds all results of the run with this key.
bool is_done(const std::string& folder, const std::string& key);
/// Marks the run as complete, as incomplete, or as having its events but not yet the rest: an interrupted run
/// that stored nothing else counts as an earlier result, too.
void note_done(const std::string& folder, const std::string& key);
void note_begun(const std::string& folder);
void note_events(const std::string& folder);

}  // namespace emberfold::apps
