// SPDX-License-Identifier: Apache-2.0
#include "pipeline/clip_synthesis.hpp"

#include <utility>

#include "core/error.hpp"
#include "core/text/check_range.hpp"
#include "pipeline/carried/carried_synthesis.hpp"
#include "pipeline/footage/footage.hpp"
#include "pipeline/footage/footage_synthesis.hpp"
#include "pipeline/frame_method.hpp"
#include "pipeline/frame_synthesis.hpp"
#include "pipeline/strokes/stroke_synthesis.hpp"
#include "pipeline/texture/texture_synthesis.hpp"
#include "sketch/rendering/sharpening.hpp"

namespace emberfold::pipeline {

namespace {

bool is_of_footage(SynthesisMethod method) {
  return method != SynthesisMethod::diffusion;
}

SynthesisMethod chosen_method(const ClipModel& model, const ClipSynthesisOptions& options) {
  return options.method.value_or(model.footage ? SynthesisMethod::footage : SynthesisMethod::diffusion);
}

void check(const ClipModel& model, const ClipSynthesisOptions& options) {
  core::check_range("ClipSynthesisOptions.speed", options.speed, -100, 100);
  const auto method = chosen_method(model, options);
  if (is_of_footage(method) && !model.footage)
    throw core::InputError("the model holds no frames of its clip");
  if (options.loop && !shows_frames(method))
    throw core::InputError("ClipSynthesisOptions.loop is for the methods footage and edit");
  if (method == SynthesisMethod::texture && (options.edit != mcmc::MotionEdit{} || options.speed != 1))
    throw core::InputError("ClipSynthesisOptions.edit and speed are not for a texture");
  if (is_of_footage(method)) return;
  if (options.edit != mcmc::MotionEdit{})
    throw core::InputError("ClipSynthesisOptions.edit is not for drawn strokes: edit their model");
  if (const auto why = why_undrawable(model.motion); !why.empty()) throw core::InputError(why);
}

FrameSynthesis begin_strokes(const ClipModel& model, const ClipSynthesisOptions& options) {
  return {mcmc::Synthesis(model.motion, options.seed, options.start),
          sketch::apply_sharpening(render_options(model.motion, model.background), model.sharpening)};
}

/// Strokes of the motion model, with levels that diffuse between them.
class DrawnStrokes final : public FrameMethod {
 public:
  DrawnStrokes(std::shared_ptr<const ClipModel> model, const ClipSynthesisOptions& options)
      : model_(std::move(model)), options_(options), frames_(begin_strokes(*model_, options)) {}

  void each(int count, const std::function<void(cv::Mat)>& take, const core::Context& context) override {
    frames_.each(count, take, context);
  }
  [[nodiscard]] int batch() const override { return frames_.batch(); }
  [[nodiscard]] const SynthesisStatistics* statistics() const override { return &frames_.statistics(); }
  [[nodiscard]] graph::MotionGraph motion(int count, const core::Context& context) const override {
    return mcmc::synthesize(model_->motion, count, options_.seed, context, options_.start);
  }

 private:
  std::shared_ptr<const ClipModel> model_;
  ClipSynthesisOptions options_;
  FrameSynthesis frames_;
};

std::unique_ptr<FrameMethod> begin(const std::shared_ptr<const ClipModel>& model, SynthesisMethod method,
                                   const ClipSynthesisOptions& options, const core::Context& context) {
  if (method == SynthesisMethod::footage)
    return std::make_unique<FootageSynthesis>(
        decode(*model->footage, context), FootageSynthesisOptions{options.seed, options.speed, options.loop},
        context);
  if (method == SynthesisMethod::edit) {
    const auto& rates = model->motion.rates;
    return std::make_unique<CarriedSynthesis>(
        decode(*model->footage, context), model->footage->strokes,
        CarriedSynthesisOptions{
            options.seed, options.edit, {rates.split_gap, rates.disconnect_gap}, options.loop},
        context);
  }
  if (method == SynthesisMethod::strokes)
    return std::make_unique<StrokeSynthesis>(decode(*model->footage, context), model->footage->strokes,
                                             StrokeSynthesisOptions{options.seed, options.edit}, context);
  if (method == SynthesisMethod::texture)
    return std::make_unique<TextureSynthesis>(decode(*model->footage, context), options.seed);
  return std::make_unique<DrawnStrokes>(model, options);
}

core::ClipInfo info_of(const ClipModel& model, SynthesisMethod method) {
  if (is_of_footage(method)) {
    const auto& clip = *model.footage;
    return {clip.size.width, clip.size.height, clip.channels, CV_8U, model.motion.fps, 255, {}};
  }
  const int channels = render_options(model.motion, model.background).channels;
  return {model.motion.width, model.motion.height, channels, CV_8U, model.motion.fps, 255, {}};
}

}  // namespace

ClipSynthesis::ClipSynthesis(ClipModel model, const ClipSynthesisOptions& options,
                             const core::Context& context)
    : options_(options), context_(context) {
  check(model, options);
  method_ = chosen_method(model, options);
  info_ = info_of(model, method_);
  model_ = std::make_shared<const ClipModel>(std::move(model));
  frames_ = begin(model_, method_, options_, context_);
}

ClipSynthesis::~ClipSynthesis() = default;
ClipSynthesis::ClipSynthesis(ClipSynthesis&&) noexcept = default;
ClipSynthesis& ClipSynthesis::operator=(ClipSynthesis&&) noexcept = default;

cv::Mat ClipSynthesis::next() {
  if (ahead_.empty())
    frames_->each(
        frames_->batch(), [&](cv::Mat frame) { ahead_.push_back(std::move(frame)); }, context_);
  cv::Mat frame = std::move(ahead_.front());
  ahead_.pop_front();
  return frame;
}

const SynthesisStatistics* ClipSynthesis::statistics() const {
  return frames_->statistics();
}

graph::MotionGraph ClipSynthesis::motion(int count) const {
  return frames_->motion(count, context_);
}

const FootageSynthesis* ClipSynthesis::footage() const {
  return dynamic_cast<const FootageSynthesis*>(frames_.get());
}

void ClipSynthesis::rewind() {
  ahead_.clear();
  frames_ = begin(model_, method_, options_, context_);
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
