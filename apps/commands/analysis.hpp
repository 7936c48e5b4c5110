// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/cli/command.hpp"
#include "apps/report/report.hpp"
#include "core/io/clip_reader.hpp"
#include "core/io/staged_output.hpp"
#include "graph/events/events.hpp"
#include "graph/io/unit_tables.hpp"
#include "pipeline/analyze.hpp"
#include "pipeline/stages/analysis_stages.hpp"

namespace emberfold::apps {

struct AnalyzeOptions : pipeline::AnalyzeOptions {
  io::ReadOptions read = {};
  bool reconstruction =
      false;          ///< write reconstruction.avi too: every frame is drawn again, not a choice of them
  bool jsonl = true;  ///< write motion.jsonl and sketch.jsonl
};

/// A clip's analysis, and what is written of it.
struct Analysis {
  std::string clip;  ///< its name in messages, report and summary
  pipeline::Analysis found;
  ReportInput report;  ///< its pictures
  nlohmann::ordered_json summary;
  Stages stages;
};

/// From a clip to what the report tells: sketches, motion, events, motion model, overlay video, pictures, all
/// but report and summary written into `output`, which the caller commits. With `stages` the model is kept
/// there instead, and what an earlier call made is not made again. Reads the clip twice and keeps of it a
/// batch of frames. With `truth` the events are scored against it. `shown_name`: how the clip is called where
/// that is not its name. core::IoError for a clip of fewer than two frames.
Analysis analyze_clip(const std::string& clip, const AnalyzeOptions& options, io::OutputFolder& output,
                      Session& session, const std::optional<std::vector<graph::Event>>& truth = {},
                      const std::string& shown_name = {}, const pipeline::AnalysisStages* stages = nullptr);

/// Writes events.json, events_all.json and events.csv.
void write_events(io::OutputFolder& output, const pipeline::Analysis& found, const graph::Units& units);

/// Writes report.html and summary.json, with what the caller added to both.
void finish_analysis(Analysis& analysis, io::OutputFolder& output, const Session& session);

}  // namespace emberfold::apps
