// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/error.hpp"
#include "pipeline/compare.hpp"

namespace emberfold::pipeline {

/// Holds the newest frames of a clip, from which others are predicted.
struct PastFrames {
  int frame = 0;                    ///< the newest frame's number in the clip, from 0
  std::span<const cv::Mat> levels;  ///< up to and including that frame, CV_32F, at least two
};

/// Holds a model of a clip as a comparison uses it.
/// begin_clip, predict and reconstruct may be called on several threads at once.
struct ComparedModel {
  using NextFrames = std::function<std::vector<cv::Mat>(int count)>;
  std::string key, label;   ///< name for programs; for display
  double parameters = 0;    ///< numbers in the model
  bool has_strokes = true;  ///< its clips are worth a sketch: not those of baselines
  /// Begins a new clip and returns the function that draws its next frames, CV_8U.
  std::function<NextFrames()> begin_clip = {};
  /// Predicts the frames at each number of steps ahead (ascending, those of TrainingInput): levels, or CV_8U.
  /// Empty for a model that does not predict.
  std::function<std::vector<cv::Mat>(const PastFrames&, std::span<const int> steps)> predict = {};
  /// Draws the newest frame as reconstructed by the model. Empty for a model without reconstruction.
  std::function<cv::Mat(const PastFrames&)> reconstruct = {};
};

/// Holds the data that models are learned from.
struct TrainingInput {
  core::FrameSource& source;
  int frames = 0, learned_frames = 0;  ///< of the clip; of its first part, which models are learned from
  std::span<const int> steps;          ///< ahead that models predict
  const SketchedClip& sketched;
  const CompareOptions& options;
  std::uint64_t seed = 1;
  const core::Context& context;
};

/// Learns each model of the comparison, in the order of its result.
/// A model that cannot be learned from this clip is left out, with a warning. Throws core::Cancelled.
std::vector<ComparedModel> learn_models(const TrainingInput& input, const KnownModels& known);

/// Returns the first frames of a sketch.
graph::SketchSequence first_frames(const graph::SketchSequence& sketch, int count);

/// Holds the motion model of a clip, and everything else that drawing and predicting need.
struct StrokeModel;
/// Learns the motion model of the clip's first part, whose matched strokes are `learned`. Null, with a
/// warning, where that fails.
std::shared_ptr<const StrokeModel> learn_strokes(const TrainingInput& input, const KnownModels& known,
                                                 const graph::MotionGraph& learned);
/// Returns the model of moving strokes with diffusion between them.
ComparedModel sketch_model(const std::shared_ptr<const StrokeModel>& strokes, std::uint64_t seed,
                           const core::Context& context);
/// Learns a linear dynamic texture.
std::optional<ComparedModel> texture_model(const TrainingInput& input, const KnownModels& known);
using SharedFrames = std::shared_ptr<const std::vector<cv::Mat>>;  ///< frames, CV_8U
/// Returns the frames that new clips are made of: the first part, or the whole clip where models of it are
/// known.
SharedFrames drawn_footage(const TrainingInput& input, const KnownModels& known);
/// Learns to predict by motion, and returns the model that makes new clips of the clip's own frames.
std::optional<ComparedModel> footage_model(const TrainingInput& input, const SharedFrames& footage);
/// Returns the model whose new clips show the clip's strokes at other times; `strokes`: those of the footage.
std::optional<ComparedModel> strokes_model(const TrainingInput& input, const SharedFrames& footage,
                                           graph::MotionGraph strokes);
/// Returns the clip's first part itself, repeated from its most similar frames (a video texture): a baseline
/// that looks real and contains nothing new.
ComparedModel loop_model(const TrainingInput& input);
/// Learns a spatio-temporal auto-regression.
std::optional<ComparedModel> star_model(const TrainingInput& input);

/// Returns make(), or nothing with a warning that begins with `none` where that fails with core::InputError
/// or core::NumericalError.
template <class Make>
auto learn_or_warn(const std::string& none, const core::Context& context, const Make& make)
    -> std::optional<decltype(make())> {
  try {
    return make();
  } catch (const core::InputError& error) {
    context.warn(none + ": " + error.what());
  } catch (const core::NumericalError& error) {
    context.warn(none + ": " + error.what());
  }
  return std::nullopt;
}

}  // namespace emberfold::pipeline
