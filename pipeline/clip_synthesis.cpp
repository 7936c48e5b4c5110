// SPDX-License-Identifier: Apache-2.0
#include "pipeline/clip_synthesis.hpp"

#include <utility>

#include "core/error.hpp"
#include "core/text/check_range.hpp"

namespace emberfold::pipeline {

namespace {

void check(const ClipModel& model, const ClipSynthesisOptions& options) {
  core::check_range("ClipSynthesisOptions.residual_speed", options.residual_speed, -100, 100);
  options.fill.validate();
  if (const auto why = why_undrawable(model.motion); !why.empty()) throw core::InputError(why);
  if (options.between == ModelFill::texture && !model.residual)
    throw core::InputError("the model holds no residual of its clip to draw a texture from");
  if (options.between == ModelFill::dytex && !model.texture)
    throw core::InputError("the model holds no texture of what lies between the strokes");
}

FrameSynthesis begin(const std::shared_ptr<const ClipModel>& model, const ClipSynthesisOptions& options) {
  auto look = sketch::apply_sharpening(render_options(model->motion, model->background, options.fill),
                                       model->sharpening);
  if (options.between == ModelFill::dytex) {
    const std::shared_ptr<const dytex::LinearDynamicTexture> texture(model, &*model->texture);
    return hybrid_frames(model->motion, texture, std::move(look), options.seed, options.start);
  }
  if (options.between == ModelFill::texture)
    return residual_frames(model->motion, *model->residual, std::move(look), options.seed, options.start,
                           options.residual_speed);
  return {mcmc::Synthesis(model->motion, options.seed, options.start), std::move(look)};
}

}  // namespace

ClipSynthesis::ClipSynthesis(ClipModel model, const ClipSynthesisOptions& options,
                             const core::Context& context)
    : options_(options), context_(context) {
  check(model, options);
  model_ = std::make_shared<const ClipModel>(std::move(model));
  frames_.emplace(begin(model_, options_));
  const auto& look = frames_->look();
  info_ = {look.size.width, look.size.height, look.channels, CV_8U, model_->motion.fps, 255, {}};
}

cv::Mat ClipSynthesis::next() {
  if (ahead_.empty())
    frames_->each(
        frames_->batch(), [&](cv::Mat frame) { ahead_.push_back(std::move(frame)); }, context_);
  cv::Mat frame = std::move(ahead_.front());
  ahead_.pop_front();
  return frame;
}

void ClipSynthesis::rewind() {
  ahead_.clear();
  frames_.emplace(begin(model_, options_));
}

void ClipSynthesis::each(int count, const std::function<void(cv::Mat)>& take) {
  for (; count > 0 && !ahead_.empty(); --count) {
    cv::Mat frame = std::move(ahead_.front());
    ahead_.pop_front();
    take(std::move(frame));
  }
  frames_->each(count, take, context_);
}

}  // namespace emberfold::pipeline
