// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace emberfold::apps {

/// What `analyze` told of one clip in its summary.json.
struct GatheredRun {
  std::string run;    ///< its folder, below the one that was gathered
  std::string group;  ///< the folder that it lies in; "all" where that is the gathered one
  std::string clip;
  int frames = 0;
  double counted_frames = 0;             ///< gaps between frames
  std::optional<double> seconds;         ///< the same in s, where the clip's rate is known
  std::optional<double> area_seconds;    ///< s mm², where the size of a pixel is known, too
  std::map<std::string, double> counts;  ///< of reported events, by class and of "all"
  std::optional<double> sure;            ///< events of probability 0.9 or more; none where it is not known
  std::vector<std::string> warnings;
};

/// Reads the summaries of all runs below a folder, in the order of their names. `groups`: a CSV file of lines
/// "run,group" that says which group a run is in instead, with a line of heads; may be empty. Runs that
/// batch.json says failed are told in `failed`. Throws core::IoError for a folder without runs, a summary
/// that is none, and a file of groups that names no run.
struct GatheredRuns {
  std::vector<GatheredRun> runs;
  std::vector<std::string> failed;  ///< "run: why"
};
GatheredRuns gather_runs(const std::filesystem::path& folder, const std::string& groups);

}  // namespace emberfold::apps
