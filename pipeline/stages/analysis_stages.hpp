// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/analyze.hpp"
#include "pipeline/sketch_clip.hpp"

namespace emberfold::pipeline {

/// Hashes of everything that each stage's results depend on.
struct StageKeys {
  std::string sketch, motion, model;
};

/// Results of match, curves and events.
struct FoundMotion {
  graph::MotionGraph motion;
  std::vector<graph::CurveJoint> joints;
  std::vector<graph::Event> all_events;
  std::vector<int> cuts;
  std::optional<mcmc::SamplerRun> sampled;  ///< where events were sampled
};

/// Results of learning.
struct LearnedModel {
  ClipModel model;
  std::array<mcmc::RateInterval, 6> rates{};
  std::vector<std::string> notes;
};

/// Stores the results of each stage of analyze() in the folder `stages` of a run, as columns
/// (io/column_folder.hpp), and reads them where a later call needs the same: results are then identical in
/// every bit. Sketches are stored block by block while they are made, so that an interrupted call loses at
/// most some frames; the model is stored next to them, in the run's folder `model`. Stages with other keys
/// are replaced.
class AnalysisStages {
 public:
  AnalysisStages(std::filesystem::path run, StageKeys keys);

  /// Sketches the clip, or the frames that are not stored.
  SketchedClip sketch(core::FrameSource& source, const sketch::ExtractOptions& options,
                      const core::Context& context) const;
  [[nodiscard]] std::optional<FoundMotion> read_motion(const core::Context& context = {}) const;
  void keep_motion(const FoundMotion& found) const;
  [[nodiscard]] std::optional<LearnedModel> read_model() const;
  /// Stores the model in the run's folder `model`.
  void keep_model(const LearnedModel& learned) const;

  /// Called with the events as soon as they are known, also where they were stored.
  std::function<void(const Analysis& found, const core::ClipInfo& info)> on_events;

 private:
  [[nodiscard]] SketchedClip read_parts(int* parts, const core::Context& context) const;

  std::filesystem::path run_, folder_;
  StageKeys keys_;
};

}  // namespace emberfold::pipeline
