// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "mcmc/simulation/edit_model.hpp"
#include "pipeline/carried/carried_play.hpp"
#include "pipeline/footage/play_order.hpp"
#include "pipeline/footage/turn.hpp"
#include "pipeline/frame_method.hpp"

namespace emberfold::pipeline {

/// Holds the settings of a CarriedSynthesis.
struct CarriedSynthesisOptions {
  std::uint64_t seed = 1;
  mcmc::MotionEdit edit = {};             ///< must be possible (edit_not_carried)
  std::array<double, 2> gaps = {10, 10};  ///< px, the widths that a split and a disconnect open
  std::optional<int> loop = {};           ///< frames after which the clip repeats itself exactly, ≥ 2
};

/// Draws an endless number of new frames of a footage, with its strokes edited.
/// The footage is played with jumps between similar frames (PlayOrder); over each frame are drawn the pixels
/// of strokes that are born elsewhere or drift, and those that hide strokes (CarriedPlay). Without edits the
/// frames are those of the footage. At another speed, frames are interpolated (draw_between), and patches,
/// too. A loop shows a round that others preceded, so that strokes which live across its end are present at
/// its beginning. The same at any number of threads.
class CarriedSynthesis final : public FrameMethod {
 public:
  /// `footage`: frames of a clip, CV_8U, 1 or 3 channels, of one size; `strokes`: those in its frames. Throws
  /// core::InputError for an edit that is not possible, fewer than two frames, and strokes of other frames;
  /// core::Cancelled.
  CarriedSynthesis(std::vector<cv::Mat> footage, graph::MotionGraph strokes,
                   const CarriedSynthesisOptions& options, const core::Context& context = {});

  void each(int count, const std::function<void(cv::Mat)>& take, const core::Context& context = {}) override;
  /// Returns the best number of frames per call: 1…16.
  [[nodiscard]] int batch() const override;
  [[nodiscard]] const SynthesisStatistics* statistics() const override { return &statistics_; }
  /// Returns the source in the clip of a frame's pixels; between two moments those of the nearer one.
  /// Returns the graphs of the clip's first `count` ≥ 1 frames, with links and identified strokes.
  [[nodiscard]] graph::MotionGraph motion(int count, const core::Context& context = {}) const override;

 private:
  /// A moment of the played footage, and what is drawn over it.
  struct Moment {
    PlayedMoment shown;
    cv::Mat1f turning;  // places, of a turn
    CarriedMoment carried;
  };
  struct DrawnMoment {
    cv::Mat frame, motion;  // to the next moment, if it was needed
  };
  [[nodiscard]] std::optional<int> played_loop() const;
  [[nodiscard]] double time(std::int64_t frame) const;
  void play_rounds(const core::Context& context);
  [[nodiscard]] Moment next_moment();
  [[nodiscard]] cv::Mat draw(const Moment& moment) const;
  void draw_moments(std::int64_t last, const core::Context& context);
  void find_motion(std::int64_t count, const core::Context& context);
  [[nodiscard]] cv::Mat frame_at(std::int64_t frame) const;

  std::shared_ptr<const SeenClip> clip_;
  CarriedSynthesisOptions options_;
  LikeMoments moments_;
  PlayOrder order_;
  CarriedPlay play_;
  std::vector<CarriedMoment> round_;  // of a loop
  SynthesisStatistics statistics_;
  std::int64_t next_frame_ = 0, next_moment_ = 0;
  std::map<std::int64_t, DrawnMoment> drawn_;
  TurningPlaces turning_;
};

}  // namespace emberfold::pipeline
