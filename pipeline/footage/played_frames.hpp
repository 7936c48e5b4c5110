// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "pipeline/footage/play_order.hpp"

namespace emberfold::pipeline {

/// Draws the moments of a played footage and the motion between them, a window of them at a time.
class PlayedFrames {
 public:
  PlayedFrames(std::shared_ptr<const std::vector<cv::Mat>> footage, PlayOrder order);

  /// Draws the moments from `first` to `last` that are not there yet, and forgets those before `first`.
  /// Throws core::Cancelled.
  void prepare(std::int64_t first, std::int64_t last, const core::Context& context);
  /// Returns a prepared moment: CV_8U, as the footage.
  [[nodiscard]] const cv::Mat& frame(std::int64_t n) const { return moments_.at(n).frame; }
  /// Returns the motion from a prepared moment, not the last one, to the next: px, CV_32FC2, at about half of
  /// the frame's size at most 2^15 vectors.
  [[nodiscard]] const cv::Mat& motion(std::int64_t n) const { return moments_.at(n).motion; }
  [[nodiscard]] const PlayOrder& order() const { return order_; }

 private:
  struct Moment {
    PlayedMoment shown;
    cv::Mat frame, motion;
  };
  using Turn = std::tuple<int, int, int>;  // the frames of both runs at its middle, and its half
  [[nodiscard]] static Turn turn_of(const PlayedMoment& shown) {
    return {shown.frame - shown.place, shown.other - shown.place, shown.half};
  }
  void find_turning_places(const std::vector<Moment*>& moments, const core::Context& context);

  std::shared_ptr<const std::vector<cv::Mat>> footage_;
  PlayOrder order_;
  std::map<std::int64_t, Moment> moments_;
  std::map<Turn, cv::Mat1f> turning_places_;  // of the moments drawn last
};

}  // namespace emberfold::pipeline
