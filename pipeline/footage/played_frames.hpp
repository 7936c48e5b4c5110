// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "pipeline/footage/play_order.hpp"
#include "pipeline/footage/seams.hpp"

namespace emberfold::pipeline {

/// Draws the moments of a played footage and the motion between them, a window at a time.
/// Several plays are shown side by side, each in its part of the frame (Seams).
class PlayedFrames {
 public:
  /// `orders`: one for each of the seams' plays; `loop`: moments after which they repeat.
  PlayedFrames(std::shared_ptr<const std::vector<cv::Mat>> footage,
               std::vector<std::shared_ptr<PlayOrder>> orders, std::shared_ptr<const Seams> seams,
               std::optional<int> loop = {});

  /// Draws the moments from `first` to `last` that are missing, and drops those before `first`.
  /// Throws core::Cancelled.
  void prepare(std::int64_t first, std::int64_t last, const core::Context& context);
  /// Returns a prepared moment: CV_8U, channels of the footage.
  [[nodiscard]] const cv::Mat& frame(std::int64_t n) const { return moments_.at(n).frame; }
  /// Returns the motion from a prepared moment, not the last one, to the next: px, CV_32FC2, at about half
  /// the frame's size, at most 2^15 vectors.
  [[nodiscard]] const cv::Mat& motion(std::int64_t n) const { return moments_.at(n).motion; }
  /// Returns the mean of the plays' relative jump costs.
  [[nodiscard]] double jump_cost() const;
  [[nodiscard]] int plays() const { return static_cast<int>(orders_.size()); }
  /// Returns whether any frames so far were played backwards.
  [[nodiscard]] bool plays_back() const;

 private:
  struct Moment {
    std::vector<PlayedMoment> shown;  // by play
    SeamLines seams;
    cv::Mat frame, motion;
  };
  void find_turning_places(const std::vector<Moment*>& moments, const core::Context& context);
  [[nodiscard]] SeamLines seams_at(std::int64_t n);
  [[nodiscard]] SeamLines next_seams(std::int64_t n, const SeamLines& before);
  [[nodiscard]] cv::Mat draw(const Moment& moment) const;
  void find_motion(std::int64_t first, std::int64_t last, const core::Context& context);
  [[nodiscard]] cv::Mat joined(const std::vector<std::pair<int, int>>& pairs, const SeamLines& seams) const;
  [[nodiscard]] static std::vector<std::pair<int, int>> shown_pairs(const Moment& moment, const Moment& next);

  std::shared_ptr<const std::vector<cv::Mat>> footage_;
  std::vector<std::shared_ptr<PlayOrder>> orders_;
  std::shared_ptr<const Seams> seams_;
  std::optional<int> loop_;
  SeamLines newest_seams_;  // of the moment before seams_next_
  std::int64_t seams_next_ = 0;
  std::vector<SeamLines> loop_seams_;  // of a whole loop
  std::map<std::int64_t, Moment> moments_;
  std::map<Turn, cv::Mat1f> turning_places_;        // of the moments drawn last
  std::map<std::pair<int, int>, cv::Mat> motions_;  // between neighbouring frames of the footage
};

}  // namespace emberfold::pipeline
