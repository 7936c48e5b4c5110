// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/cli/run_progress.hpp"
#include "apps/commands/analysis.hpp"
#include "core/clip.hpp"

namespace emberfold::apps {

/// What an analysis will take on this machine.
struct RunEstimate {
  double frames = 0;
  double processor_seconds = 0;
  double seconds = 0;  ///< with the threads that it may use
  double memory_mb =
      0;  ///< that is its own; graphs lie in files, of which the system holds what it has room for
  double disk_mb = 0;  ///< of its folder
  std::vector<PlannedStage> stages;
};

/// Sketches two frames of the clip, of its first 200, and tells from the time that takes, their size and
/// their patches how long all of it will take; about, for frames differ. Nothing where the number of frames
/// is not known. Rewinds the source. Cost: two sketched frames, and up to 150 read.
std::optional<RunEstimate> estimate_run(core::FrameSource& source, const AnalyzeOptions& options,
                                        int threads);

/// Returns the estimate in a line; where it is long, with what makes it shorter.
std::string words_of(const RunEstimate& estimate, const core::ClipInfo& info);

}  // namespace emberfold::apps
