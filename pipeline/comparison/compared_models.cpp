// SPDX-License-Identifier: Apache-2.0
#include "pipeline/comparison/compared_models.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/clip/clip_range.hpp"
#include "core/context.hpp"
#include "core/error.hpp"
#include "dytex/baselines/star.hpp"
#include "dytex/synthesize.hpp"
#include "pipeline/comparison/clip_strokes.hpp"
#include "pipeline/parameter_count.hpp"

namespace emberfold::pipeline {

namespace {

template <class Result>
void pass_on_notes(const Result& result, const char* what, const core::Context& context) {
  for (const auto& note : result.notes) context.warn(std::string(what) + ": " + note);
}

}  // namespace

std::optional<ComparedModel> texture_model(const TrainingInput& input, const KnownModels& known) {
  const core::Context& context = input.context;
  core::ClipRange learned_part(input.source, 0, input.learned_frames);
  auto learned = learn_or_warn("no linear dynamic texture", context, [&] {
    auto options = input.options.learn;
    options.components = std::min(options.components, std::max(1, input.learned_frames / 3));
    auto result = dytex::learn(learned_part, options, context);
    pass_on_notes(result, "linear dynamic texture", context);
    return std::move(result.texture);
  });
  if (!learned) return std::nullopt;
  const auto texture = std::make_shared<const dytex::LinearDynamicTexture>(std::move(*learned));
  ComparedModel model{"linear_dynamic_texture", "linear dynamic texture"};
  model.parameters = parameter_count(*texture);
  const auto drawn = known.texture != nullptr
                         ? std::shared_ptr<const dytex::LinearDynamicTexture>(known.texture, [](auto*) {})
                         : texture;
  model.begin_clip = [drawn, seed = input.seed]() -> ComparedModel::NextFrames {
    dytex::SynthesisOptions options;
    options.seed = seed;
    return [drawn, synthesis = std::make_shared<dytex::Synthesis>(*drawn, options)](int count) {
      std::vector<cv::Mat> frames;
      for (int i = 0; i < count; ++i) frames.push_back(synthesis->next());
      return frames;
    };
  };
  model.predict = [texture](const PastFrames& past, std::span<const int> steps) {
    Eigen::VectorXd state = dytex::expected_state(*texture, dytex::project(*texture, past.levels.back()));
    std::vector<cv::Mat> predicted;
    for (int i = 1; predicted.size() < steps.size(); ++i) {
      state = texture->A * state;
      if (i == steps[predicted.size()]) predicted.push_back(dytex::draw(*texture, state));
    }
    return predicted;
  };
  model.reconstruct = [texture](const PastFrames& past) {
    return dytex::draw(*texture, dytex::project(*texture, past.levels.back()));
  };
  return model;
}

std::optional<ComparedModel> star_model(const TrainingInput& input) {
  const core::Context& context = input.context;
  core::ClipRange learned_part(input.source, 0, input.learned_frames);
  auto learned = learn_or_warn("no auto-regression", context, [&] {
    auto result = dytex::learn_star(learned_part, {}, context);
    pass_on_notes(result, "STAR", context);
    return std::move(result.star);
  });
  if (!learned) return std::nullopt;
  const auto star = std::make_shared<const dytex::Star>(std::move(*learned));
  ComparedModel model{"star", "STAR model"};
  model.has_strokes = false;
  const auto channels = static_cast<double>(star->info.channels);
  model.parameters =
      static_cast<double>(star->mean.size() + star->coefficients.size()) + channels * (channels + 1) / 2;
  model.begin_clip = [star, seed = input.seed]() -> ComparedModel::NextFrames {
    return [star, synthesis = std::make_shared<dytex::StarSynthesis>(*star, seed)](int count) {
      std::vector<cv::Mat> frames;
      for (int i = 0; i < count; ++i) frames.push_back(synthesis->next());
      return frames;
    };
  };
  model.predict = [star](const PastFrames& past, std::span<const int> steps) {
    const auto all = dytex::predict(*star, past.levels, steps.back());
    std::vector<cv::Mat> predicted;
    for (const int step : steps) predicted.push_back(all[static_cast<std::size_t>(step - 1)]);
    return predicted;
  };
  return model;
}

std::vector<ComparedModel> learn_models(const TrainingInput& input, const KnownModels& known) {
  std::vector<ComparedModel> models;
  const auto add = [&](std::optional<ComparedModel> model) {
    if (model) models.push_back(std::move(*model));
  };
  const auto matched = [&](int frames) {
    return match_strokes(first_frames(input.sketched.sketch, frames), input.options.match, input.context);
  };
  graph::MotionGraph learned = matched(input.learned_frames);
  const auto strokes = learn_strokes(input, known, learned);
  if (strokes) add(sketch_model(strokes, input.seed, input.context));
  if (const auto footage =
          learn_or_warn("no footage", input.context, [&] { return drawn_footage(input, known); })) {
    add(footage_model(input, *footage));
    const auto drawn = static_cast<int>((*footage)->size());
    add(strokes_model(input, *footage, drawn == input.learned_frames ? std::move(learned) : matched(drawn)));
  }
  add(texture_model(input, known));
  if (input.options.in_full) add(star_model(input));
  models.push_back(loop_model(input));
  return models;
}

}  // namespace emberfold::pipeline
