// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace emberfold::dytex {

/// The autocorrelation in time ρ(τ) = c(τ)/c(0). c(τ) is the covariance of pixels with themselves τ frames
/// later, about each pixel's own mean over the clip, summed over all pixels and divided by the T − τ pairs.
/// Holds 2 `lags` frames; O(pixels · lags) a frame.
class Autocorrelation {
 public:
  /// Throws InputError unless the size is at least 1×1 and lags is 1 … 256.
  Autocorrelation(cv::Size size, int lags);

  /// Adds the next frame: luma, CV_32F, white = 255. InputError for another size or type.
  void add(const cv::Mat& luma);
  /// Returns ρ(1) … ρ(lags). All 1 where nothing ever changes. InputError with lags frames or fewer.
  [[nodiscard]] Eigen::VectorXd values() const;

 private:
  cv::Size size_;
  int lags_, frames_ = 0;
  cv::Mat reference_;           // the first frame, subtracted from all others, so that little cancels
  cv::Mat sum_;                 // CV_64F
  std::vector<cv::Mat> first_;  // the first frames, at most lags
  std::vector<cv::Mat> last_;   // the last ones, at most lags, the newest at the end
  Eigen::VectorXd products_;    // of frames τ apart, τ = 0 … lags
};

/// Returns √mean (p − q)²; 0 for equals, symmetric. InputError unless both have the same size ≥ 1.
double autocorrelation_distance(const Eigen::Ref<const Eigen::VectorXd>& p,
                                const Eigen::Ref<const Eigen::VectorXd>& q);

}  // namespace emberfold::dytex
