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
#include "graph/matching/match.hpp"
#include "mcmc/learning/fit.hpp"
#include "mcmc/sampler/infer.hpp"
#include "pipeline/calibration.hpp"
#include "pipeline/readings.hpp"
#include "pipeline/sketch_clip.hpp"
#include "sketch/extract.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/rendering/sharpening.hpp"

namespace emberfold::apps {

struct AnalyzeOptions {
  io::ReadOptions read;
  sketch::ExtractOptions sketch;
  graph::MatchOptions match;
  sketch::FillOptions fill;
  pipeline::StartOptions starts;
  mcmc::InferOptions infer;
  pipeline::CalibrateOptions calibrate;
  int texture = 0;           ///< components of the texture between the strokes, 1…500; 0: none is learned
  bool bottom_up = false;    ///< no sampler: the match as it is, each event of probability 1
  bool keep_sketch = false;  ///< in the analysis: sketches as extracted, and grounds
  bool reconstruction =
      false;  ///< write reconstruction.avi too: every frame is drawn again, not a choice of them
};

/// A clip and all that was found in it.
struct Analysis {
  std::string clip;                 ///< as it is called
  pipeline::SketchedClip sketched;  ///< empty unless asked for
  graph::MotionGraph motion;
  sketch::Sharpening sharpening;
  std::vector<graph::Event> events;      ///< of probability 0.5 or more
  std::vector<graph::Event> all_events;  ///< of whatever probability
  mcmc::FitResult fitted;
  std::optional<mcmc::InferResult> sampled;  ///< where there was a sampler, and what it tells besides:
  std::vector<RateInterval> rates;
  ReportInput report;  ///< its pictures
  nlohmann::ordered_json summary;
  Stages stages;
};

/// From a clip to what the report tells: sketches, motion, events, motion model, overlay video, pictures, all
/// but report and summary written into `output`, which the caller commits. Reads the clip twice and keeps of
/// it a batch of frames. With `truth` the events are scored against it. `shown_name`: how the clip is called
/// where that is not its name. core::IoError for a clip of fewer than two frames.
Analysis analyze_clip(const std::string& clip, const AnalyzeOptions& options, io::OutputFolder& output,
                      Session& session, const std::optional<std::vector<graph::Event>>& truth = {},
                      const std::string& shown_name = {});

/// Writes report.html and summary.json, with what the caller added to both.
void finish_analysis(Analysis& analysis, io::OutputFolder& output, const Session& session);

}  // namespace emberfold::apps
