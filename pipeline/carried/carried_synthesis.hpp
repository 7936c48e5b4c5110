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
#include "graph/motion_graph.hpp"
#include "mcmc/simulation/edit_model.hpp"
#include "pipeline/carried/carried_play.hpp"
#include "pipeline/footage/frame_sources.hpp"
#include "pipeline/footage/play_order.hpp"
#include "pipeline/frame_synthesis.hpp"

namespace emberfold::pipeline {

/// Holds the settings of a CarriedSynthesis.
struct CarriedSynthesisOptions {
  std::uint64_t seed = 1;
  mcmc::MotionEdit edit = {};             ///< one that is carried (edit_not_carried)
  std::array<double, 2> gaps = {10, 10};  ///< px that a split and a disconnect open
  std::optional<int> loop = {};           ///< frames after which the clip repeats itself exactly, ≥ 2
};

/// Draws new frames of a footage without end, with its strokes edited.
/// The footage is played with jumps between like moments (PlayOrder); on each frame lie the pixels of strokes
/// that are born elsewhere or drift, and what hides those that are not to be seen (CarriedPlay). Without
/// edits frames are those of the footage. At another speed frames lie between those so drawn (draw_between),
/// and patches on the way from one to the next. A loop shows the round of moments before which others went,
/// so that strokes that live on across its end are there at its beginning. The same at any number of threads.
class CarriedSynthesis {
 public:
  /// `footage`: frames of a clip, CV_8U, 1 or 3 channels, of one size; `strokes`: those seen in them.
  /// Throws core::InputError for an edit that is not carried, fewer than two frames and strokes of others;
  /// core::Cancelled.
  CarriedSynthesis(std::vector<cv::Mat> footage, graph::MotionGraph strokes,
                   const CarriedSynthesisOptions& options, const core::Context& context = {});

  /// Draws the next `count` frames, CV_8U, on several threads and hands them to `take` in order.
  /// Throws core::Cancelled.
  void each(int count, const std::function<void(cv::Mat)>& take, const core::Context& context = {});
  /// Returns the best number of frames to ask for at once: 1…16.
  [[nodiscard]] int batch() const;
  /// Returns the statistics of the frames so far.
  [[nodiscard]] const SynthesisStatistics& statistics() const { return statistics_; }
  /// Returns where in the clip the pixels of a frame come from, between two moments of the nearer one; to be
  /// called while it is handed to each()'s `take`.
  [[nodiscard]] FrameSources sources() const;
  /// Returns the graphs of the clip's first `count` ≥ 1 frames, with links and identified strokes.
  /// Throws core::Cancelled.
  [[nodiscard]] graph::MotionGraph motion(int count, const core::Context& context = {}) const;

 private:
  /// What a moment of the played footage shows, and what is drawn over it.
  struct Moment {
    PlayedMoment shown;
    cv::Mat1f turning;  // places, of a turn
    CarriedMoment carried;
  };
  struct DrawnMoment {
    cv::Mat frame, motion;  // to the next moment, where it was needed
    PlayedMoment shown;
    std::vector<CarriedStroke> strokes;
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
  cv::Mat1b moves_;                   // where the clip moves
  SynthesisStatistics statistics_;
  std::int64_t next_frame_ = 0, next_moment_ = 0;
  std::map<std::int64_t, DrawnMoment> drawn_;
  Turn turn_;  // of `turning_`
  cv::Mat1f turning_;
};

}  // namespace emberfold::pipeline
