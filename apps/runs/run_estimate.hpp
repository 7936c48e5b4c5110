// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/cli/run_progress.hpp"
#include "core/clip.hpp"
#include "pipeline/analyze.hpp"

namespace emberfold::apps {

/// What an analysis will take on this machine.
struct RunEstimate {
  double frames = 0;
  double processor_seconds = 0;
  double seconds = 0;  ///< with the threads that it may use
  double memory_mb = 0;
  std::vector<PlannedStage> stages;
};

/// Sketches the clip's first frame, and tells from the time that takes, its size and its patches how long all
/// of it will take; about, for frames differ. Nothing where the number of frames is not known. Rewinds the
/// source. Cost: one sketched frame.
std::optional<RunEstimate> estimate_run(core::FrameSource& source, const pipeline::AnalyzeOptions& options,
                                        int threads);

/// Returns the estimate in a line; where it is long, with what makes it shorter.
std::string words_of(const RunEstimate& estimate, const core::ClipInfo& info);

}  // namespace emberfold::apps
