// SPDX-License-Identifier: Apache-2.0
#include "pipeline/clip_synthesis.hpp"

#include <utility>

#include "core/error.hpp"
#include "core/text/check_range.hpp"

namespace emberfold::pipeline {

namespace {

ModelFill chosen_fill(const ClipModel& model, const ClipSynthesisOptions& options) {
  return options.fill_kind.value_or(model.footage ? ModelFill::footage : ModelFill::diffusion);
}

void check(const ClipModel& model, const ClipSynthesisOptions& options) {
  core::check_range("ClipSynthesisOptions.speed", options.speed, -100, 100);
  const auto fill = chosen_fill(model, options);
  if ((fill == ModelFill::footage || fill == ModelFill::carried) && !model.footage)
    throw core::InputError("the model holds no frames of its clip");
  if (fill == ModelFill::footage) return;
  if (fill == ModelFill::carried) return;
  if (options.loop) throw core::InputError("ClipSynthesisOptions.loop is not for drawn strokes");
  if (options.edit != mcmc::MotionEdit{})
    throw core::InputError("ClipSynthesisOptions.edit is for carried strokes alone");
  if (const auto why = why_undrawable(model.motion); !why.empty()) throw core::InputError(why);
  if (fill == ModelFill::texture && !model.residual)
    throw core::InputError("the model holds no residual of its clip to draw a texture from");
  if (fill == ModelFill::dytex && !model.texture)
    throw core::InputError("the model holds no texture of what lies between the strokes");
}

FrameSynthesis begin_strokes(const std::shared_ptr<const ClipModel>& model, ModelFill fill,
                             const ClipSynthesisOptions& options) {
  auto look = sketch::apply_sharpening(render_options(model->motion, model->background), model->sharpening);
  if (fill == ModelFill::dytex) {
    const std::shared_ptr<const dytex::LinearDynamicTexture> texture(model, &*model->texture);
    return hybrid_frames(model->motion, texture, std::move(look), options.seed, options.start);
  }
  if (fill == ModelFill::texture)
    return residual_frames(model->motion, *model->residual, std::move(look), options.seed, options.start,
                           options.speed * model->residual->speed);
  return {mcmc::Synthesis(model->motion, options.seed, options.start), std::move(look)};
}

CarriedSynthesisOptions carried_options(const ClipModel& model, const ClipSynthesisOptions& options) {
  return {options.seed,
          options.edit,
          {model.motion.rates.split_gap, model.motion.rates.disconnect_gap},
          options.loop};
}

}  // namespace

ClipSynthesis::ClipSynthesis(ClipModel model, const ClipSynthesisOptions& options,
                             const core::Context& context)
    : options_(options), context_(context) {
  check(model, options);
  fill_kind_ = chosen_fill(model, options);
  if (fill_kind_ != ModelFill::footage && fill_kind_ != ModelFill::carried) correct_rates(model, context);
  model_ = std::make_shared<const ClipModel>(std::move(model));
  begin();
  const double fps = model_->motion.fps;
  if (footage_ || carried_) {
    const auto& clip = *model_->footage;
    info_ = {clip.size.width, clip.size.height, clip.channels, CV_8U, fps, 255, {}};
  } else {
    const auto& look = frames_->look();
    info_ = {look.size.width, look.size.height, look.channels, CV_8U, fps, 255, {}};
  }
}

void ClipSynthesis::begin() {
  if (fill_kind_ == ModelFill::footage)
    footage_.emplace(decode(*model_->footage, context_),
                     FootageSynthesisOptions{options_.seed, options_.speed, options_.loop}, context_);
  else if (fill_kind_ == ModelFill::carried)
    carried_.emplace(decode(*model_->footage, context_), model_->footage->strokes,
                     carried_options(*model_, options_), context_);
  else
    frames_.emplace(begin_strokes(model_, fill_kind_, options_));
}

void ClipSynthesis::draw(int count, const std::function<void(cv::Mat)>& take) {
  if (footage_)
    footage_->each(count, take, context_);
  else if (carried_)
    carried_->each(count, take, context_);
  else
    frames_->each(count, take, context_);
}

cv::Mat ClipSynthesis::next() {
  if (ahead_.empty())
    draw(footage_   ? footage_->batch()
         : carried_ ? carried_->batch()
                    : frames_->batch(),
         [&](cv::Mat frame) { ahead_.push_back(std::move(frame)); });
  cv::Mat frame = std::move(ahead_.front());
  ahead_.pop_front();
  return frame;
}

graph::MotionGraph ClipSynthesis::motion(int count) const {
  if (footage_) throw core::InputError("a clip of footage draws no strokes");
  if (carried_) return carried_->motion(count, context_);
  return mcmc::synthesize(model_->motion, count, options_.seed, context_, options_.start);
}

FrameSources ClipSynthesis::sources() const {
  if (footage_) return footage_->sources();
  if (carried_) return carried_->sources();
  throw core::InputError("drawn strokes have no source in the clip");
}

void ClipSynthesis::rewind() {
  ahead_.clear();
  begin();
}

void ClipSynthesis::each(int count, const std::function<void(cv::Mat)>& take) {
  for (; count > 0 && !ahead_.empty(); --count) {
    cv::Mat frame = std::move(ahead_.front());
    ahead_.pop_front();
    take(std::move(frame));
  }
  draw(count, take);
}

}  // namespace emberfold::pipeline
