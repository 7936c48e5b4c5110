// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace emberfold::apps {

/// Results of `analyze` for one clip, from its summary.json.
struct GatheredRun {
  std::string run;    ///< its folder, below the gathered one
  std::string group;  ///< the folder that contains it; "all" where that is the gathered one
  std::string clip;
  int frames = 0;
  double counted_frames = 0;             ///< gaps between frames
  std::optional<double> seconds;         ///< the same in s, where the frame rate is known
  std::optional<double> area_seconds;    ///< s mm², where the pixel size is known, too
  std::map<std::string, double> counts;  ///< of reported events, by class and in "all"
  std::optional<double> sure;            ///< events of probability 0.9 or more; none where unknown
  std::vector<std::string> warnings;
};

/// Reads the summaries of all runs below a folder, in the order of their names.
/// `groups`: a CSV file of lines "run,group" with a header that overrides a run's group; may be empty. Runs
/// that failed according to batch.json are listed in `failed`. Throws core::IoError for a folder without
/// runs, an invalid summary, and a file of groups that names no run.
struct GatheredRuns {
  std::vector<GatheredRun> runs;
  std::vector<std::string> failed;  ///< "run: why"
};
GatheredRuns gather_runs(const std::filesystem::path& folder, const std::string& groups);

}  // namespace emberfold::apps
