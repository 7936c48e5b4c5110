// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/curves/curve_identity.hpp"
#include "graph/events/event_names.hpp"
#include "graph/events/events.hpp"
#include "graph/events/review.hpp"
#include "graph/matching/match.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/learning/clip_statistics.hpp"
#include "mcmc/learning/fit.hpp"
#include "mcmc/sampler/sampler_run.hpp"
#include "pipeline/clip_model.hpp"
#include "pipeline/review/review_calibration.hpp"
#include "pipeline/sketch_clip.hpp"
#include "sketch/extract.hpp"

namespace emberfold::pipeline {

/// Holds the settings of analyze().
struct AnalyzeOptions {
  sketch::ExtractOptions sketch = kFollowedSketch;
  graph::MatchOptions match = {};
  bool bottom_up = false;     ///< the match unchanged, each event of probability 1
  bool curve_events = false;  ///< events of curves, not of strokes; touching and crossing are no events
  /// Also follows figures, things wider than a line (find_figures); not with the two options above.
  bool figures = true;
  double least_probability = 0.5;  ///< 0…1, of reported events
  bool keep_sketch = false;        ///< keep sketches as extracted, and the backgrounds of the frames
  /// Answers of a person about the clip's events: taken as facts, the others are inferred anew
  /// (apply_review).
  std::optional<std::vector<graph::ReviewedEvent>> review = {};
  std::uint64_t seed = 1;
  std::string clip = "the clip";  ///< its name in messages
};

/// Names the effort spent on a clip's events.
enum class Quality {
  draft,  ///< the match unchanged: every event has probability 1
  normal  ///< events are weighed by what the images show
};
/// Returns the quality of that name; nothing for an unknown name.
std::optional<Quality> quality(std::string_view name);
/// Sets the options of a quality; normal changes nothing.
void set_quality(AnalyzeOptions& options, Quality quality);

/// Holds the results of analyze().
struct Analysis {
  SketchedClip sketched;  ///< empty without AnalyzeOptions::keep_sketch
  /// With strokes and curves. Strokes keep their identity where no event changes them (graph::keep_identity),
  /// and skipped patches are linked (graph::link_skipped_patches), unless events are of curves, or taken as
  /// matched.
  graph::MotionGraph motion;
  std::vector<graph::CurveJoint> joints;  ///< where curves continue each other or touch
  std::vector<graph::Event> events;       ///< of AnalyzeOptions::least_probability or more
  std::vector<graph::Contact> contacts;   ///< how the parts meet, for each of `events`
  std::vector<graph::Event> all_events;   ///< of any probability
  std::vector<int> cuts;                  ///< frames that begin another picture (FirstLook)
  ClipModel model;
  /// Rates of births, deaths, splits, merges, connects and disconnects, per frame, with their intervals.
  std::array<mcmc::RateInterval, 6> rates{};
  std::optional<mcmc::SamplerRun> sampled;  ///< how a sampler ran; none without one
  std::optional<ReviewedClip> reviewed;     ///< with AnalyzeOptions::review; its events are all_events
  std::vector<core::StageTime> stages;
};

class AnalysisStages;

/// Analyses a clip: sketches, motion, events and the model that new clips are drawn from.
/// Each event has the probability that it happened (mcmc::sample_changes), unless options ask otherwise.
/// Reads the clip several times, frame by frame, and keeps all graphs. `stages`: stores the results of each
/// stage and returns those that an earlier call stored. Equal clips, options and seeds give equal results at
/// any number of threads. Warns of numbers that were not taken as measured. Throws core::IoError for a clip
/// of fewer than two frames, core::InputError for options out of range, core::Cancelled. Example:
///
///     auto clip = io::open_video("flag.avi");
///     auto result = pipeline::analyze(*clip, {});
///     io::write_model("flag_model", to_archive(result.model));
Analysis analyze(core::FrameSource& source, const AnalyzeOptions& options = {},
                 const core::Context& context = {}, const AnalysisStages* stages = nullptr);

}  // namespace emberfold::pipeline
