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
      false;          ///< also write reconstruction.avi: every frame is reconstructed, not a selection
  bool jsonl = true;  ///< write motion.jsonl and sketch.jsonl
};

/// A clip's analysis, and what its outputs need.
struct Analysis {    // NOLINT(bugprone-exception-escape): moving JSON does not throw
  std::string clip;  ///< its name in messages, report and summary
  pipeline::Analysis found;
  ReportInput report;  ///< its pictures
  nlohmann::ordered_json summary;
  Stages stages;
};

/// Analyses a clip up to the report: sketches, motion, events, motion model, overlay video, pictures.
/// Writes all but report and summary into `output`, which the caller commits. With `stages` the model is
/// stored there instead, and results of an earlier call are reused. Reads the clip twice and keeps a batch of
/// frames. With `truth` the events are scored against it. `shown_name`: the clip's displayed name, if
/// different. Throws core::IoError for a clip of fewer than two frames.
Analysis analyze_clip(const std::string& clip, const AnalyzeOptions& options, io::OutputFolder& output,
                      Session& session, const std::optional<std::vector<graph::Event>>& truth = {},
                      const std::string& shown_name = {}, const pipeline::AnalysisStages* stages = nullptr);

/// Writes events.json, events_all.json and events.csv.
void write_events(io::OutputFolder& output, const pipeline::Analysis& found, const graph::Units& units);

/// Writes report.html and summary.json, with the caller's additions to both.
void finish_analysis(Analysis& analysis, io::OutputFolder& output, const Session& session);

}  // namespace emberfold::apps
