// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "pipeline/comparison/clip_measures.hpp"
#include "pipeline/comparison/comparison_results.hpp"

namespace emberfold::pipeline {

/// Returns the figures of VisibleFigures, in the order of its fields.
std::span<const MeasureDescription> visible_measures();

/// Returns the picture on which a frame's luma (CV_32F) is measured: CV_8U, half its size, and at most 2^16
/// px.
cv::Mat visible_picture(const cv::Mat& luma);

/// Measures drawn clips against a source: where its SD over time is above 8 levels, or at the 15 % of the
/// pixels that move most. Patches are those of the source's second half, compared in 16 principal components.
class VisibleMeasures {
 public:
  /// Number of a clip's first frames that are measured.
  static constexpr std::size_t kMostFrames = 200;

  /// `source`: visible_pictures of at least 8 frames. Takes about 0.1 s per thousand patches.
  VisibleMeasures(std::vector<cv::Mat> source, const core::Context& context);

  /// Measures a clip of at least 3 visible_pictures; reduces them to the source's size. The same at any
  /// number of threads. Throws core::Cancelled.
  [[nodiscard]] VisibleFigures measure(std::vector<cv::Mat> clip, const core::Context& context) const;

 private:
  struct Motion {
    double flow = 0, variance = 0, difference = 0;
  };
  [[nodiscard]] cv::Mat patches(std::span<const cv::Mat> clip, int count, std::uint32_t stream) const;
  [[nodiscard]] Motion motion(const std::vector<cv::Mat>& clip, const core::Context& context) const;
  [[nodiscard]] cv::Mat components(const cv::Mat& patches) const;

  std::vector<cv::Mat> source_;
  cv::Mat1b moves_;
  std::vector<cv::Point> places_;  // centres of the patches
  cv::Mat mean_, axes_;            // of patches
  cv::Mat all_, second_half_;      // the source's patches, in components
  double base_ = 1;                // their distance to the first half
  Motion motion_;
};

}  // namespace emberfold::pipeline
