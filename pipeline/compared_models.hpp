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

/// A moment of a clip, with what came before it.
struct Moment {
  int frame = 0;                  ///< counts from the clip's first
  std::span<const cv::Mat> past;  ///< levels up to and with that frame, CV_32F, at least two
};

/// A model of a clip as a comparison sees it. What follows may be asked on several threads at once.
struct ComparedModel {
  using Frames = std::function<std::vector<cv::Mat>(int count)>;
  std::string key, label;  ///< in measures.json; to read
  std::string file;        ///< the clip drawn from it
  double parameters = 0;   ///< numbers that it holds
  /// Begins a new clip: gives its next frames, CV_8U.
  std::function<Frames()> draw = {};
  /// The frames expected so many steps (ascending, of ModelInput's) after the moment: levels, or CV_8U.
  std::function<std::vector<cv::Mat>(const Moment&, std::span<const int> steps)> foretell = {};
  /// The moment's own frame as the model can show it. None: it has no such thing.
  std::function<cv::Mat(const Moment&)> reconstruct = {};
};

/// What models are learned from.
struct ModelInput {
  core::FrameSource& source;
  int frames = 0, first = 0;   ///< of the clip; learned is from those before `first`
  std::span<const int> steps;  ///< that models are to foretell
  const SketchedClip& sketched;
  const CompareOptions& options;
  std::uint64_t seed = 1;
  const core::Context& context;
};

/// Learns each model of the comparison, in the order in which they are shown. One that this clip does not
/// yield is left out, with a warning. Throws core::Cancelled.
std::vector<ComparedModel> learn_models(const ModelInput& input, const KnownModels& known);

/// The motion model of a clip, and what else it takes to draw from it and to foretell.
struct Strokes;
/// Null, with a warning, where this clip yields none.
std::shared_ptr<const Strokes> learn_strokes(const ModelInput& input, const KnownModels& known);
/// Strokes that move, and diffusion between them.
ComparedModel sketch_model(const std::shared_ptr<const Strokes>& strokes, std::uint64_t seed,
                           const core::Context& context);
/// The same strokes, and between them a linear dynamic texture learned with the strokes hidden.
std::optional<ComparedModel> hybrid_model(const std::shared_ptr<const Strokes>& strokes,
                                          const ModelInput& input);
/// A linear dynamic texture of so many components, of frames reduced by `scale` (0 … 1].
std::optional<ComparedModel> texture_model(const ModelInput& input, const KnownModels& known, int components,
                                           double scale = 1);
/// Spatio-temporal auto-regression; `reach`: as dytex::StarOptions.
std::optional<ComparedModel> star_model(const ModelInput& input, int reach);

/// make(), or nothing and a warning that begins with `none` where this clip yields no such model.
template <class Make>
auto attempt(const std::string& none, const core::Context& context, const Make& make)
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

/// Numbers that a model holds, as far as they are needed to draw from it.
double parameter_count(const mcmc::MotionModel& model);
double parameter_count(const dytex::LinearDynamicTexture& texture);

}  // namespace emberfold::pipeline
