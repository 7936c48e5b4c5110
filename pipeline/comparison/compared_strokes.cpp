// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include <opencv2/core.hpp>

#include "core/clip/clip_range.hpp"
#include "core/context.hpp"
#include "core/error.hpp"
#include "mcmc/learning/fit.hpp"
#include "mcmc/simulation/predict.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "pipeline/clip_model.hpp"
#include "pipeline/comparison/clip_strokes.hpp"
#include "pipeline/comparison/compared_models.hpp"
#include "pipeline/frame_synthesis.hpp"
#include "pipeline/parameter_count.hpp"
#include "sketch/background/static_pixels.hpp"
#include "sketch/background/still_background.hpp"
#include "sketch/rendering/frame_renderer.hpp"
#include "sketch/rendering/sharpening.hpp"

namespace emberfold::pipeline {

struct StrokeModel {
  mcmc::MotionModel model, drawn;                           // learned; for drawing
  sketch::Background ground, drawn_ground;                  // likewise
  std::vector<graph::AttributeGraph> sketches;              // of every frame
  std::map<int, std::vector<graph::AttributeGraph>> ahead;  // by steps: the predicted graph for every frame
  core::ClipInfo info;
  float level = 0;                // of a drawn frame without content
  sketch::Sharpening sharpening;  // of drawn clips

  // Returns the graph expected `steps` frames later; for 0 the frame's own.
  [[nodiscard]] const graph::AttributeGraph& graph(const PastFrames& past, int steps) const {
    const auto& all = steps == 0 ? sketches : ahead.at(steps);
    return all[static_cast<std::size_t>(past.frame) + static_cast<std::size_t>(steps)];
  }
  [[nodiscard]] sketch::RenderOptions look(float empty_level, const sketch::Background& around) const {
    return {{info.width, info.height}, info.channels, empty_level, around};
  }
  // Returns the options for drawing a clip.
  [[nodiscard]] sketch::RenderOptions drawn_look() const {
    return sketch::apply_sharpening(look(level, drawn_ground), sharpening);
  }
};

namespace {

cv::Mat draw_strokes(const StrokeModel& strokes, const PastFrames& past, int steps) {
  // A frame without strokes gets the mean level of the newest frame there.
  const auto level = static_cast<float>(cv::mean(core::luma(past.levels.back()))[0]);
  return sketch::render_frame(strokes.graph(past, steps), strokes.look(level, strokes.ground));
}

float mean_level(core::FrameSource& source) {
  source.rewind();
  return static_cast<float>(cv::mean(core::luma(source.next(), source.info()))[0]);
}

double ground_numbers(const sketch::Background& ground) {
  const auto& [levels, still] = ground.static_pixels;
  const double pixels = levels.empty() ? 0 : static_cast<double>(cv::countNonZero(still) * levels.channels());
  return pixels + static_cast<double>(ground.levels.total()) * std::max(1, ground.levels.channels());
}

/// Prepares the learned model for drawing, as `analyze` does.
void prepare_drawing(StrokeModel& strokes, const TrainingInput& input) {
  const core::Context& context = input.context;
  core::ClipRange learned_part(input.source, 0, input.learned_frames);
  const double wanted = sketch::measure_clip_flank_gradient(
                            learned_part, first_frames(input.sketched.sketch, input.learned_frames), context)
                            .mean();
  strokes.sharpening = fit_sharpening(strokes.model, strokes.drawn_ground, wanted, input.seed, context);
  strokes.drawn = strokes.model;
}

}  // namespace

graph::SketchSequence first_frames(const graph::SketchSequence& sketch, int count) {
  graph::SketchSequence first = sketch;
  first.frames.resize(static_cast<std::size_t>(count));
  return first;
}

std::shared_ptr<const StrokeModel> learn_strokes(const TrainingInput& input, const KnownModels& known,
                                                 const graph::MotionGraph& learned) {
  const auto& [sketch, grounds] = input.sketched;
  const core::Context& context = input.context;
  StrokeModel strokes;
  strokes.info = input.source.info();
  strokes.ground =
      sketch::estimate_background(std::span(grounds).first(static_cast<std::size_t>(input.learned_frames)));
  core::ClipRange learned_part(input.source, 0, input.learned_frames);
  strokes.ground.static_pixels = sketch::find_static_pixels(learned_part, context);
  strokes.drawn_ground = strokes.ground;
  if (known.motion_model != nullptr) {
    strokes.drawn_ground = sketch::estimate_background(grounds);
    strokes.drawn_ground.static_pixels = sketch::find_static_pixels(input.source, context);
  }
  strokes.sketches = sketch.frames;
  strokes.level = mean_level(input.source);
  try {
    mcmc::FitOptions options;
    options.seed = input.seed;
    options.calibrate = known.motion_model == nullptr;  // balanced rates serve drawing alone
    auto fitted = mcmc::fit(learned, options, context);
    for (const auto& note : fitted.notes) context.warn("motion model: " + note);
    strokes.model = std::move(fitted.model);
    if (known.motion_model != nullptr)
      strokes.drawn = *known.motion_model,
      strokes.sharpening = known.sharpening != nullptr ? *known.sharpening : sketch::Sharpening{};
    else
      prepare_drawing(strokes, input);
  } catch (const core::InputError& error) {
    context.warn(std::string("no motion model: ") + error.what());
    return nullptr;
  }
  if (input.learned_frames < input.frames) {
    // Flicker removal uses later frames, which a prediction must not see.
    auto causal = input.options.match;
    causal.flicker = 0;
    const auto motion = match_strokes(sketch, causal, context);
    for (const int step : input.steps) strokes.ahead[step] = mcmc::predict(strokes.model, motion, step);
  }
  return std::make_shared<const StrokeModel>(std::move(strokes));
}

ComparedModel sketch_model(const std::shared_ptr<const StrokeModel>& strokes, std::uint64_t seed,
                           const core::Context& context) {
  ComparedModel model{"motion_model", "motion model"};
  model.parameters = parameter_count(strokes->model) + ground_numbers(strokes->ground);
  model.begin_clip = [strokes, seed, context]() -> ComparedModel::NextFrames {
    const auto frames =
        std::make_shared<FrameSynthesis>(mcmc::Synthesis(strokes->drawn, seed), strokes->drawn_look());
    return [frames, context](int count) { return frames->next(count, context); };
  };
  model.predict = [strokes](const PastFrames& past, std::span<const int> steps) {
    std::vector<cv::Mat> predicted;
    for (const int step : steps) predicted.push_back(draw_strokes(*strokes, past, step));
    return predicted;
  };
  model.reconstruct = [strokes](const PastFrames& past) { return draw_strokes(*strokes, past, 0); };
  return model;
}

}  // namespace emberfold::pipeline
