// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace emberfold::dytex {

/// The parts of a motion vector.
enum class FlowPart : std::size_t { x, y, speed };

/// Histograms of a clip's optical flow: of its components with their signs (which separate a clip from its
/// reversal) and of its length, in steps of 1/16 px a frame up to ± 64.
class FlowHistograms {
 public:
  static constexpr int kMostSpeed = 64, kBinsPerPixel = 16, kBins = 2 * kMostSpeed * kBinsPerPixel + 1;

  /// Adds a motion field, CV_32FC2, px a frame, of which every `stride`-th pixel each way is used. Skips
  /// vectors that are not finite. Throws InputError for another type or stride < 1.
  void add(const cv::Mat& flow, int stride = 1);
  /// Returns the shares of −64 … 64, sum 1; all 0 while nothing was added.
  [[nodiscard]] Eigen::VectorXd shares(FlowPart part) const;

 private:
  std::array<Eigen::VectorXd, 3> counts_{Eigen::VectorXd::Zero(kBins), Eigen::VectorXd::Zero(kBins),
                                         Eigen::VectorXd::Zero(kBins)};
};

/// Returns the Wasserstein distance (of the first kind) of two histograms, px a frame: ∫ |F − G|. Throws
/// InputError where either is empty.
double flow_distance(const FlowHistograms& a, const FlowHistograms& b, FlowPart part);
/// Returns the largest of the distances of the three parts.
double flow_distance(const FlowHistograms& a, const FlowHistograms& b);

}  // namespace emberfold::dytex
