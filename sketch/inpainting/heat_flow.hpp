// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace emberfold::sketch {

/// Simulates heat diffusion in time: ∂u/∂t = Δu with held pixels and an insulated border. Explicit steps of
/// the 5-point stencil. Its limit is the result of fill(), which is faster; this class shows the way there.
class HeatFlow {
 public:
  static constexpr double kLargestStep = 0.25;  ///< px²: beyond it the scheme is not stable

  /// Begins with `levels`: CV_32F, 1 or 3 channels, finite. Pixels where `mask` (CV_8U, same size) is not 0
  /// are held. `step`: px² of time a step, above 0, at most kLargestStep. Throws core::InputError otherwise.
  HeatFlow(const cv::Mat& levels, const cv::Mat& mask, double step = kLargestStep);

  /// Makes `steps` ≥ 0 steps. No level ever leaves the range of the first ones. O(pixels) a step; one thread.
  void advance(std::int64_t steps);

  [[nodiscard]] cv::Mat levels() const;  ///< a copy; held pixels as they came, bit for bit
  [[nodiscard]] std::int64_t steps() const { return steps_; }
  [[nodiscard]] double time() const { return static_cast<double>(steps_) * step_; }  ///< px²

 private:
  void step_rows();

  int width_, height_, channels_;
  double step_;
  std::int64_t steps_ = 0;
  std::vector<float> low_, high_;  // of the first levels, along one row
  std::vector<float> rate_;        // step, or 0 where held
  std::vector<float> now_, next_;  // with a border of one pixel
};

}  // namespace emberfold::sketch
