// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"

namespace emberfold::sketch {

/// The diffusion as it goes on in time: ∂u/∂t = Δu by explicit steps of the 5-point stencil, with an
/// insulated border and held pixels. Its limit is what fill() returns at once; this one is for showing the
/// way there.
class HeatFlow {
 public:
  static constexpr double kLargestStep = 0.25;  ///< px²: beyond it the scheme is not stable

  /// Begins with `levels`: CV_32F, 1 or 3 channels, finite; those where `mask` (CV_8U, same size) is not 0
  /// are held. `step`: px² of time a step, above 0, at most kLargestStep. InputError otherwise.
  HeatFlow(const cv::Mat& levels, const cv::Mat& mask, double step = kLargestStep);

  /// `steps` ≥ 0. No level ever leaves the range of the first ones. O(pixels) a step; one thread.
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

/// The frames of a film of the diffusion: the levels after each of `steps`, which must not decrease. Throws
/// core::Cancelled.
std::vector<cv::Mat> make_heat_film(const cv::Mat& levels, const cv::Mat& mask,
                                    std::span<const std::int64_t> steps, const core::Context& context = {});

}  // namespace emberfold::sketch
