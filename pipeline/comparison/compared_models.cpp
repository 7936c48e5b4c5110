// SPDX-License-Identifier: Apache-2.0
#include "pipeline/comparison/compared_models.hpp"

#include <algorithm>
#include <memory>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/clip/clip_range.hpp"
#include "core/context.hpp"
#include "core/error.hpp"
#include "dytex/baselines/star.hpp"
#include "dytex/synthesize.hpp"
#include "pipeline/parameter_count.hpp"

namespace emberfold::pipeline {

namespace {

template <class Result>
void pass_on_notes(const Result& result, const char* what, const core::Context& context) {
  for (const auto& note : result.notes) context.warn(std::string(what) + ": " + note);
}

cv::Mat resize_to(const cv::Mat& frame, cv::Size size) {
  if (frame.size() == size) return frame;
  cv::Mat out;
  const bool reduced = size.area() < frame.size().area();
  cv::resize(frame, out, size, 0, 0, reduced ? cv::INTER_AREA : cv::INTER_LINEAR);
  return out;
}

// Gives the frames of a source as levels, reduced in size.
class ReducedSource final : public core::FrameSource {
 public:
  ReducedSource(core::FrameSource& source, double scale) : source_(source), info_(source.info()) {
    info_.width = std::max(1, cvRound(info_.width * scale)),
    info_.height = std::max(1, cvRound(info_.height * scale));
    info_.depth = CV_32F, info_.white = 255;
  }
  [[nodiscard]] const core::ClipInfo& info() const override { return info_; }
  cv::Mat next() override {
    const cv::Mat frame = source_.next();
    return frame.empty() ? frame
                         : resize_to(core::to_levels(frame, source_.info()), {info_.width, info_.height});
  }
  void rewind() override { source_.rewind(); }

 private:
  core::FrameSource& source_;
  core::ClipInfo info_;
};

std::vector<cv::Mat> resize_all(std::vector<cv::Mat> frames, cv::Size size) {
  for (auto& frame : frames) frame = resize_to(frame, size);
  return frames;
}

}  // namespace

std::optional<ComparedModel> texture_model(const TrainingInput& input, const KnownModels& known,
                                           int components, double scale) {
  const core::Context& context = input.context;
  core::ClipRange learned_part(input.source, 0, input.learned_frames);
  ReducedSource reduced(learned_part, scale);
  core::FrameSource& source = scale < 1 ? static_cast<core::FrameSource&>(reduced) : learned_part;
  auto learned = learn_or_warn("no linear dynamic texture", context, [&] {
    auto options = input.options.learn;
    options.components = std::min(components, std::max(1, input.learned_frames / 3));
    auto result = dytex::learn(source, options, context);
    pass_on_notes(result, "linear dynamic texture", context);
    return std::move(result.texture);
  });
  if (!learned) return std::nullopt;
  const cv::Size size(input.source.info().width, input.source.info().height),
      inner(source.info().width, source.info().height);
  const auto texture = std::make_shared<const dytex::LinearDynamicTexture>(std::move(*learned));
  ComparedModel model{"linear_dynamic_texture", "linear dynamic texture"};
  model.parameters = parameter_count(*texture);
  const auto drawn = known.texture != nullptr && scale >= 1
                         ? std::shared_ptr<const dytex::LinearDynamicTexture>(known.texture, [](auto*) {})
                         : texture;
  model.begin_clip = [drawn, size, seed = input.seed]() -> ComparedModel::NextFrames {
    dytex::SynthesisOptions options;
    options.seed = seed;
    return [drawn, size, synthesis = std::make_shared<dytex::Synthesis>(*drawn, options)](int count) {
      std::vector<cv::Mat> frames;
      for (int i = 0; i < count; ++i) frames.push_back(synthesis->next());
      return resize_all(std::move(frames), size);
    };
  };
  model.predict = [texture, size, inner](const PastFrames& past, std::span<const int> steps) {
    Eigen::VectorXd state =
        dytex::expected_state(*texture, dytex::project(*texture, resize_to(past.levels.back(), inner)));
    std::vector<cv::Mat> predicted;
    for (int i = 1; predicted.size() < steps.size(); ++i) {
      state = texture->A * state;
      if (i == steps[predicted.size()]) predicted.push_back(resize_to(dytex::draw(*texture, state), size));
    }
    return predicted;
  };
  model.reconstruct = [texture, size, inner](const PastFrames& past) {
    return resize_to(dytex::draw(*texture, dytex::project(*texture, resize_to(past.levels.back(), inner))),
                     size);
  };
  return model;
}

std::optional<ComparedModel> star_model(const TrainingInput& input, int reach) {
  const core::Context& context = input.context;
  core::ClipRange learned_part(input.source, 0, input.learned_frames);
  auto learned = learn_or_warn("no auto-regression", context, [&] {
    dytex::StarOptions options;
    options.reach = reach;
    auto result = dytex::learn_star(learned_part, options, context);
    pass_on_notes(result, "STAR", context);
    return std::move(result.star);
  });
  if (!learned) return std::nullopt;
  const auto star = std::make_shared<const dytex::Star>(std::move(*learned));
  ComparedModel model{"star", "STAR model"};
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
  const auto strokes = learn_strokes(input, known);
  if (strokes) add(sketch_model(strokes, input.seed, input.context));
  add(footage_model(input, known));
  add(texture_model(input, known, input.options.learn.components));
  if (input.options.in_full) add(star_model(input, dytex::StarOptions{}.reach));
  models.push_back(loop_model(input));
  return models;
}

}  // namespace emberfold::pipeline
