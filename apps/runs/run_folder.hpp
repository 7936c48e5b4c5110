// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "apps/commands/analysis.hpp"
#include "pipeline/stages/analysis_stages.hpp"

// A run is a folder that can be gone on with: analyze keeps in it what each stage made.
namespace emberfold::apps {

/// Hashes of what each stage of a run depends on.
struct RunKeys {
  pipeline::StageKeys stages;
  std::string run;  ///< of all, pictures and report included
};

/// Returns the keys of an analysis; nothing for a clip that cannot be told from another, a pipe. `review`:
/// the file of reviewed events, or empty.
std::optional<RunKeys> run_keys(const std::string& clip, const std::string& review,
                                const AnalyzeOptions& options, std::uint64_t seed);

/// Returns whether the folder holds all that a run with this key makes.
bool is_done(const std::string& folder, const std::string& key);
/// Notes that it does; that it does not yet; or that its events are there, the rest not yet: an interrupted
/// run that kept nothing else is an earlier result, too.
void note_done(const std::string& folder, const std::string& key);
void note_begun(const std::string& folder);
void note_events(const std::string& folder);

}  // namespace emberfold::apps
