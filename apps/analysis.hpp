// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "apps/clip_reader.hpp"
#include "apps/command.hpp"
#include "apps/output_folder.hpp"
#include "graph/events.hpp"
#include "graph/match.hpp"
#include "sketch/extract.hpp"
#include "sketch/fill.hpp"

namespace emberfold::apps {

struct AnalyzeOptions {
  ReadOptions read;
  sketch::ExtractOptions sketch;
  graph::MatchOptions match;
  sketch::FillOptions fill;
  bool reconstruction =
      false;  ///< write reconstruction.avi too: every frame is drawn again, not a choice of them
};

/// From a clip to its report: sketches, motion, events, overlay video, pictures, summary, all written into
/// `output`, which the caller commits. Reads the clip twice and keeps of it a batch of frames. Returns the
/// summary. With `truth` the events are scored against it. `shown_name`: how the clip is called where that is
/// not its name. core::IoError for a clip of fewer than two frames.
nlohmann::ordered_json analyze_clip(const std::string& clip, const AnalyzeOptions& options,
                                    OutputFolder& output, Session& session,
                                    const std::optional<std::vector<graph::Event>>& truth = {},
                                    const std::string& shown_name = {});

}  // namespace emberfold::apps
