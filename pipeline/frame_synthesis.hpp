// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "mcmc/model/motion_model.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "pipeline/frame_method.hpp"
#include "sketch/rendering/fade_in_out.hpp"
#include "sketch/rendering/frame_renderer.hpp"

namespace emberfold::pipeline {

/// Returns the options for drawing a model's graphs.
/// They have the model's size, one channel where all its levels are grey, its background, and the mean of its
/// strokes' sides where a frame has neither strokes nor background.
sketch::RenderOptions render_options(const mcmc::MotionModel& model, sketch::Background ground);

/// Draws an endless number of new frames of a model, with the diffusion between its strokes.
/// The frames are the same at any number of threads and calls.
class FrameSynthesis {
 public:
  FrameSynthesis(mcmc::Synthesis strokes, sketch::RenderOptions look);

  /// Draws the next `count` frames, CV_8U, on several threads and hands them to `take`.
  /// They are handed over in order and one at a time, while the next ones are drawn. At most batch() frames
  /// are held. Throws core::Cancelled.
  void each(int count, const std::function<void(cv::Mat)>& take, const core::Context& context = {});
  /// Returns the next `count` frames at once.
  std::vector<cv::Mat> next(int count, const core::Context& context = {});
  /// Returns the contents of the next `count` frames without drawing them.
  std::vector<sketch::FrameContent> parts(int count, const core::Context& context = {});
  /// Returns the best number of frames per call: 16, or those that 192 MB hold.
  [[nodiscard]] int batch() const;
  /// Returns the statistics of the frames so far.
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
  SynthesisStatistics statistics_;
  std::deque<Drawn> ahead_;
  sketch::FadeInOut fader_;
};

}  // namespace emberfold::pipeline
