// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace emberfold::dytex {

/// What is taken of a vector of motion.
enum class FlowPart : std::size_t { x, y, speed };

/// How fast and where to the pixels of a clip move: histograms of optical flow, of its components with their
/// signs (which tell a clip from its reversal) and of its length, in steps of 1/16 px a frame up to ± 64.
class FlowShares {
 public:
  static constexpr int kMostSpeed = 64, kBinsPerPixel = 16, kBins = 2 * kMostSpeed * kBinsPerPixel + 1;

  /// A field of motion, CV_32FC2, px a frame; every `stride`-th pixel each way is taken. What is not finite
  /// is passed over. InputError for another type or stride < 1.
  void add(const cv::Mat& flow, int stride = 1);
  /// Shares of −64 … 64, sum 1; all 0 while nothing was added.
  [[nodiscard]] Eigen::VectorXd shares(FlowPart part) const;

 private:
  std::array<Eigen::VectorXd, 3> counts_{Eigen::VectorXd::Zero(kBins), Eigen::VectorXd::Zero(kBins),
                                         Eigen::VectorXd::Zero(kBins)};
};

/// The Wasserstein distance (of the first kind) of two laws, px a frame: how far on average motion must be
/// changed to turn one into the other; ∫ |F − G|. InputError where either has nothing.
double flow_distance(const FlowShares& a, const FlowShares& b, FlowPart part);
/// The largest of the three.
double flow_distance(const FlowShares& a, const FlowShares& b);

}  // namespace emberfold::dytex
