// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "mcmc/simulation/edit_model.hpp"
#include "pipeline/footage/copied_share.hpp"
#include "pipeline/footage/turn.hpp"
#include "pipeline/frame_method.hpp"
#include "pipeline/strokes/stroke_play.hpp"

namespace emberfold::pipeline {

/// Holds the settings of a StrokeSynthesis.
struct StrokeSynthesisOptions {
  std::uint64_t seed = 1;
  mcmc::MotionEdit edit = {};  ///< must be possible (edit_not_repeated)
};

/// Draws an endless number of new frames from strokes of a clip that live again at other times.
/// Each frame shows the strips of its strokes (StrokePlay, draw_strips) on the frame of the clip that is
/// played (PlayOrder), which takes their levels beside them (sketch::fill_onto). The same at any number of
/// threads.
class StrokeSynthesis final : public FrameMethod {
 public:
  /// `footage`: frames of a clip, CV_8U, 1 or 3 channels, of one size; `strokes`: those in its frames. Throws
  /// core::InputError for an edit that is not possible, fewer than two frames, and strokes of other frames;
  /// core::Cancelled.
  StrokeSynthesis(std::vector<cv::Mat> footage, graph::MotionGraph strokes,
                  const StrokeSynthesisOptions& options, const core::Context& context = {});

  void each(int count, const std::function<void(cv::Mat)>& take, const core::Context& context = {}) override;
  /// Returns the best number of frames per call: 1…16.
  [[nodiscard]] int batch() const override;
  [[nodiscard]] const SynthesisStatistics* statistics() const override { return &statistics_; }
  /// Throws core::InputError: pixels of one frame come from many.
  /// Returns the graphs of the clip's first `count` ≥ 1 frames, with links and identified strokes.
  [[nodiscard]] graph::MotionGraph motion(int count, const core::Context& context = {}) const override;

 private:
  struct Moment {
    StrokeMoment strokes;
    cv::Mat1f turning;  // places, of a transition
  };
  [[nodiscard]] Moment next_moment();
  [[nodiscard]] cv::Mat draw(const Moment& moment) const;

  std::shared_ptr<const SeenClip> clip_;
  StrokeSynthesisOptions options_;
  LikeMoments moments_;
  StrokePlay play_;
  TurningPlaces turning_;
  CopiedShare copied_;
  SynthesisStatistics statistics_;
  std::int64_t drawn_ = 0;
};

}  // namespace emberfold::pipeline
