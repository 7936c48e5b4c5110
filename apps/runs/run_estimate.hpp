// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/cli/run_progress.hpp"
#include "apps/commands/analysis.hpp"
#include "core/clip.hpp"

namespace emberfold::apps {

/// The expected cost of an analysis on this machine.
struct RunEstimate {
  double frames = 0;
  double processor_seconds = 0;
  double seconds = 0;  ///< with the permitted threads
  double memory_mb =
      0;  ///< of the process itself; graphs are in files that the system caches while memory allows
  double disk_mb = 0;  ///< of the run's folder
  std::vector<PlannedStage> stages;
};

/// Estimates the time and memory of an analysis from two sketched frames, of the clip's first 200.
/// Uses the time that these take, their size and their patches; approximate, since frames differ. Nothing
/// where the number of frames is unknown. Rewinds the source. Cost: two sketched frames, and up to 150 read.
std::optional<RunEstimate> estimate_run(core::FrameSource& source, const AnalyzeOptions& options,
                                        int threads);

/// Returns the estimate as one line; if it is long, with options that shorten it.
std::string words_of(const RunEstimate& estimate, const core::ClipInfo& info);

}  // namespace emberfold::apps
