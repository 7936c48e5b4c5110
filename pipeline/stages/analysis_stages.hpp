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

/// Hashes of all that each stage's results depend on.
struct StageKeys {
  std::string sketch, motion, model;
};

/// What match, curves and events found.
struct FoundMotion {
  graph::MotionGraph motion;
  std::vector<graph::CurveJoint> joints;
  std::vector<graph::Event> all_events;
};

/// What was learned of the clip.
struct LearnedModel {
  ClipModel model;
  std::array<mcmc::RateInterval, 6> rates{};
  std::vector<std::string> notes;
  std::optional<LearnedTexture> texture;
};

/// Keeps what each stage of analyze() made in the folder `stages` of a run, as columns
/// (io/column_folder.hpp), and reads it again where a later call wants the same: results are then the same in
/// every bit. Sketches are kept block by block while they are made, so that a call that is stopped loses some
/// frames at most; the model lies beside, in the run's folder `model`. Stages of other keys are replaced.
class AnalysisStages {
 public:
  AnalysisStages(std::filesystem::path run, StageKeys keys);

  /// Sketches the clip, or what is missing of it.
  SketchedClip sketch(core::FrameSource& source, const sketch::ExtractOptions& options,
                      const core::Context& context) const;
  [[nodiscard]] std::optional<FoundMotion> read_motion(const core::Context& context = {}) const;
  void keep_motion(const FoundMotion& found) const;
  [[nodiscard]] std::optional<LearnedModel> read_model() const;
  /// Keeps the model in the run's folder `model`.
  void keep_model(const LearnedModel& learned) const;

  /// Called with the events as soon as they are known, also where they were kept.
  std::function<void(const Analysis& found, const core::ClipInfo& info)> on_events;

 private:
  [[nodiscard]] SketchedClip read_parts(int* parts, const core::Context& context) const;

  std::filesystem::path run_, folder_;
  StageKeys keys_;
};

}  // namespace emberfold::pipeline
