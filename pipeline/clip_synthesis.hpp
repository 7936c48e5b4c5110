// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "mcmc/simulation/edit_model.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "pipeline/clip_model.hpp"
#include "pipeline/frame_method.hpp"

namespace emberfold::pipeline {

/// Holds the settings of a ClipSynthesis.
struct ClipSynthesisOptions {
  std::uint64_t seed = 1;
  std::optional<ModelFill> fill_kind = {};  ///< none: the model's footage, or without one the diffusion
  mcmc::Start start = mcmc::Start::data;    ///< the clip's own strokes, or the model's stationary law
  double speed = 1;                         ///< speed of the footage, −100…100, not 0; below 0 backwards
  mcmc::MotionEdit edit = {};    ///< of ModelFill::carried and strokes; else edit the model (edit_model)
  std::optional<int> loop = {};  ///< for footage and carried: frames until the clip repeats, ≥ 2
};

class FootageSynthesis;

/// Draws an endless number of new frames of a clip's model: CV_8U, with the model's size and rate.
/// Equal models, options and seeds give equal frames, whatever the number of threads and calls. Example:
///
///     pipeline::ClipSynthesis synthesis(model, {.seed = 7});
///     io::write_video("new.mp4", synthesis, 300);
class ClipSynthesis final : public core::FrameSource {
 public:
  /// Keeps a copy of the model; where strokes are drawn from it, a pending correction of its rates comes
  /// first (correct_rates). Throws core::InputError where it lacks the part that options.fill_kind needs;
  /// core::Cancelled.
  explicit ClipSynthesis(ClipModel model, const ClipSynthesisOptions& options = {},
                         const core::Context& context = {});

  [[nodiscard]] const core::ClipInfo& info() const override { return info_; }
  /// Returns the next frame; several are drawn at once, ahead of it. Throws core::Cancelled.
  cv::Mat next() override;
  /// Starts again from the first frame.
  void rewind() override;
  /// Draws the next `count` frames on several threads and hands them to `take`.
  /// They are handed over in order and one at a time, while the next ones are drawn. Throws core::Cancelled.
  void each(int count, const std::function<void(cv::Mat)>& take);
  /// Returns statistics of the strokes drawn so far, those ahead of next() included; null for a footage.
  [[nodiscard]] const SynthesisStatistics* statistics() const { return method_->statistics(); }
  /// Returns the graphs of the clip's first `count` ≥ 1 frames with their links. Throws core::InputError for
  /// a clip of footage, which draws no strokes; core::Cancelled.
  [[nodiscard]] graph::MotionGraph motion(int count) const { return method_->motion(count, context_); }
  /// Returns the synthesis of the footage; null where strokes are drawn.
  [[nodiscard]] const FootageSynthesis* footage() const;
  /// Returns the sources in the clip of a frame's pixels.
  /// To be called while each() hands the frame over, and not after next(). Throws core::InputError where
  /// strokes are drawn.
  [[nodiscard]] FrameSources sources() const { return method_->sources(); }
  /// Returns the source of the clip.
  [[nodiscard]] ModelFill fill_kind() const { return fill_kind_; }

 private:
  std::shared_ptr<const ClipModel> model_;
  ClipSynthesisOptions options_;
  core::Context context_;
  core::ClipInfo info_;
  ModelFill fill_kind_ = ModelFill::diffusion;
  std::unique_ptr<FrameMethod> method_;
  std::deque<cv::Mat> ahead_;
};

}  // namespace emberfold::pipeline
