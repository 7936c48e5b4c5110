// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace emberfold::pipeline {

/// Measures how much of new frames is copied from single frames of a footage.
class CopiedShare {
 public:
  static constexpr int kEvery = 4;  ///< compares every fourth new frame
  /// Examines up to 4096 moving pixels, evenly spread. `footage`: CV_8U, of one size; `moves`: its
  /// moving_pixels.
  CopiedShare(const std::vector<cv::Mat>& footage, const cv::Mat1b& moves);

  /// Adds a new frame. O(frames of the footage).
  void add(const cv::Mat& frame);
  /// Returns the mean over frames of the share of examined pixels within 2 levels of the footage's frame with
  /// most such pixels; 0 without frames or motion.
  [[nodiscard]] double mean() const { return frames_ == 0 ? 0 : sum_ / frames_; }

 private:
  [[nodiscard]] cv::Mat picked(const cv::Mat& frame) const;

  std::vector<cv::Point> pixels_;
  std::vector<cv::Mat> footage_;  // one row of examined pixels each
  double sum_ = 0;
  int frames_ = 0;
};

}  // namespace emberfold::pipeline
