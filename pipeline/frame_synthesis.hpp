// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "dytex/linear_dynamic_texture.hpp"
#include "mcmc/model/motion_model.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "pipeline/residual_texture.hpp"
#include "sketch/rendering/fade_in_out.hpp"
#include "sketch/rendering/frame_renderer.hpp"

namespace emberfold::pipeline {

/// How frames of a model's graphs are drawn: its size, grey where all its levels are, its ground, and the
/// mean of its strokes' sides where a frame has neither.
sketch::RenderOptions render_options(const mcmc::MotionModel& model, sketch::Background ground,
                                     const sketch::FillOptions& fill);

/// What a clip drawn from a model holds.
struct SynthesisStatistics {
  std::vector<std::size_t> patches, strokes;  ///< of each frame
  std::array<std::size_t, 6> operators{};     ///< births, deaths, splits, merges, connects, disconnects
};

/// New frames of a model without an end, drawn from its graphs and, where there are any, its grounds. The
/// same frames whatever the number of threads and of calls.
class FrameSynthesis {
 public:
  /// `between`: called once for each frame, in order, to add a ground or a residual; none: the diffusion.
  using Between = std::function<void(sketch::FrameContent&)>;
  FrameSynthesis(mcmc::Synthesis strokes, sketch::RenderOptions look, Between between = {});

  /// Draws the next `count` frames, CV_8U, on several threads and hands them to `take`, in order and one at a
  /// time, while the next ones are drawn. At most as many are held as batch() tells. Throws core::Cancelled.
  void each(int count, const std::function<void(cv::Mat)>& take, const core::Context& context = {});
  /// All of them at once.
  std::vector<cv::Mat> next(int count, const core::Context& context = {});
  /// What the next `count` frames are drawn from, instead of them.
  std::vector<sketch::FrameContent> parts(int count, const core::Context& context = {});
  /// How many frames are best asked for at once: 16, or as many as 192 MB hold.
  [[nodiscard]] int batch() const;
  /// Of the frames so far.
  [[nodiscard]] const SynthesisStatistics& statistics() const { return statistics_; }
  [[nodiscard]] const sketch::RenderOptions& look() const { return look_; }

 private:
  struct Drawn {
    graph::AttributeGraph graph;
    std::array<int, 6> operators{};
  };
  Drawn take();
  sketch::FrameContent next_parts();

  mcmc::Synthesis strokes_;
  sketch::RenderOptions look_;
  Between between_;
  SynthesisStatistics statistics_;
  std::deque<Drawn> ahead_;
  sketch::FadeInOut fader_;
};

/// Strokes of a motion model on the ground that a texture of the same clip draws (learn_background_texture),
/// frame by frame in step; channels as the texture's. core::InputError where the sizes disagree.
FrameSynthesis hybrid_frames(const mcmc::MotionModel& model,
                             std::shared_ptr<const dytex::LinearDynamicTexture> texture,
                             sketch::RenderOptions look, std::uint64_t seed,
                             mcmc::Start start = mcmc::Start::data);

/// Strokes of a motion model, what diffuses from them, and the clip's residual on all, which runs
/// `residual_speed` times as fast.
FrameSynthesis residual_frames(const mcmc::MotionModel& model, const ResidualTexture& residual,
                               sketch::RenderOptions look, std::uint64_t seed,
                               mcmc::Start start = mcmc::Start::data, double residual_speed = 1);

}  // namespace emberfold::pipeline
