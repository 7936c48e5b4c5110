// SPDX-License-Identifier: Apache-2.0
#include "pipeline/compared_models.hpp"

#include <algorithm>
#include <memory>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/clip/clip_range.hpp"
#include "core/context.hpp"
#include "core/error.hpp"
#include "dytex/baselines/star.hpp"
#include "dytex/synthesize.hpp"

namespace emberfold::pipeline {

namespace {

template <class Result>
void check_learned(const Result& result, const char* what, const core::Context& context) {
  for (const auto& note : result.notes) context.warn(std::string(what) + ": " + note);
}

cv::Mat resized(const cv::Mat& frame, cv::Size size) {
  if (frame.size() == size) return frame;
  cv::Mat out;
  const bool reduced = size.area() < frame.size().area();
  cv::resize(frame, out, size, 0, 0, reduced ? cv::INTER_AREA : cv::INTER_LINEAR);
  return out;
}

// The frames of a source, as levels, reduced.
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
                         : resized(core::to_levels(frame, source_.info()), {info_.width, info_.height});
  }
  void rewind() override { source_.rewind(); }

 private:
  core::FrameSource& source_;
  core::ClipInfo info_;
};

std::vector<cv::Mat> enlarged(std::vector<cv::Mat> frames, cv::Size size) {
  for (auto& frame : frames) frame = resized(frame, size);
  return frames;
}

}  // namespace

std::optional<ComparedModel> texture_model(const ModelInput& input, const KnownModels& known, int components,
                                           double scale) {
  const core::Context& context = input.context;
  core::ClipRange part(input.source, 0, input.first);
  ReducedSource reduced(part, scale);
  core::FrameSource& source = scale < 1 ? static_cast<core::FrameSource&>(reduced) : part;
  auto learned = attempt("no linear dynamic texture", context, [&] {
    auto options = input.options.learn;
    options.components = std::min(components, std::max(1, input.first / 3));
    auto result = dytex::learn(source, options, context);
    check_learned(result, "linear dynamic texture", context);
    return std::move(result.texture);
  });
  if (!learned) return std::nullopt;
  const cv::Size size(input.source.info().width, input.source.info().height),
      inner(source.info().width, source.info().height);
  const auto texture = std::make_shared<const dytex::LinearDynamicTexture>(std::move(*learned));
  ComparedModel model{"linear_dynamic_texture", "linear dynamic texture", "synthesized_dytex.avi"};
  model.parameters = parameter_count(*texture);
  const auto drawn = known.texture != nullptr && scale >= 1
                         ? std::shared_ptr<const dytex::LinearDynamicTexture>(known.texture, [](auto*) {})
                         : texture;
  model.draw = [drawn, size, seed = input.seed]() -> ComparedModel::Frames {
    dytex::SynthesisOptions options;
    options.seed = seed;
    return [drawn, size, synthesis = std::make_shared<dytex::Synthesis>(*drawn, options)](int count) {
      std::vector<cv::Mat> frames;
      for (int i = 0; i < count; ++i) frames.push_back(synthesis->next());
      return enlarged(std::move(frames), size);
    };
  };
  model.foretell = [texture, size, inner](const Moment& moment, std::span<const int> steps) {
    Eigen::VectorXd state =
        dytex::expected_state(*texture, dytex::project(*texture, resized(moment.past.back(), inner)));
    std::vector<cv::Mat> told;
    for (int i = 1; told.size() < steps.size(); ++i) {
      state = texture->A * state;
      if (i == steps[told.size()]) told.push_back(resized(dytex::draw(*texture, state), size));
    }
    return told;
  };
  model.reconstruct = [texture, size, inner](const Moment& moment) {
    return resized(dytex::draw(*texture, dytex::project(*texture, resized(moment.past.back(), inner))), size);
  };
  return model;
}

std::optional<ComparedModel> star_model(const ModelInput& input, int reach) {
  const core::Context& context = input.context;
  core::ClipRange part(input.source, 0, input.first);
  auto learned = attempt("no auto-regression", context, [&] {
    dytex::StarOptions options;
    options.reach = reach;
    auto result = dytex::learn_star(part, options, context);
    check_learned(result, "STAR", context);
    return std::move(result.star);
  });
  if (!learned) return std::nullopt;
  const auto star = std::make_shared<const dytex::Star>(std::move(*learned));
  ComparedModel model{"star", "STAR model", "synthesized_star.avi"};
  const auto channels = static_cast<double>(star->info.channels);
  model.parameters =
      static_cast<double>(star->mean.size() + star->coefficients.size()) + channels * (channels + 1) / 2;
  model.draw = [star, seed = input.seed]() -> ComparedModel::Frames {
    return [star, synthesis = std::make_shared<dytex::StarSynthesis>(*star, seed)](int count) {
      std::vector<cv::Mat> frames;
      for (int i = 0; i < count; ++i) frames.push_back(synthesis->next());
      return frames;
    };
  };
  model.foretell = [star](const Moment& moment, std::span<const int> steps) {
    const auto all = dytex::predict(*star, moment.past, steps.back());
    std::vector<cv::Mat> told;
    for (const int step : steps) told.push_back(all[static_cast<std::size_t>(step - 1)]);
    return told;
  };
  return model;
}

std::vector<ComparedModel> learn_models(const ModelInput& input, const KnownModels& known) {
  std::vector<ComparedModel> models;
  const auto add = [&](std::optional<ComparedModel> model) {
    if (model) models.push_back(std::move(*model));
  };
  const auto strokes = learn_strokes(input, known);
  if (strokes) add(sketch_model(strokes, input.seed, input.context));
  if (strokes && input.options.hybrid) add(hybrid_model(strokes, input));
  add(texture_model(input, known, input.options.learn.components));
  if (input.options.star) add(star_model(input, dytex::StarOptions{}.reach));
  return models;
}

}  // namespace emberfold::pipeline
