// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace emberfold::dytex {

/// The planes of a clip in which patterns are found.
enum class Plane : std::size_t { xy, xt, yt };

/// Local binary patterns on three orthogonal planes (LBP-TOP: Zhao, Pietikäinen 2007): at every inner pixel
/// of every inner frame and in each plane, which of the eight neighbours at distance 1 (next in the grid, not
/// interpolated) are at least as bright: one of 256 patterns. Levels are rounded to whole ones first. Holds
/// three frames; O(pixels) a frame.
class BinaryPatterns {
 public:
  /// Adds the next frame: luma, CV_32F, white = 255. InputError for another type, or another size than
  /// before.
  void add(const cv::Mat& luma);
  /// Returns the shares of the 256 patterns, sum 1; all 0 with fewer than 3 frames or frames below 3×3.
  [[nodiscard]] Eigen::VectorXd shares(Plane plane) const;

 private:
  std::array<cv::Mat, 3> frames_;  // CV_8U, the newest last
  std::array<Eigen::VectorXd, 3> counts_{Eigen::VectorXd::Zero(256), Eigen::VectorXd::Zero(256),
                                         Eigen::VectorXd::Zero(256)};
};

/// Returns ½ Σ (p − q)²/(p + q), 0 … 1 for shares. Throws InputError for different sizes or a negative value.
double chi_square_distance(const Eigen::Ref<const Eigen::VectorXd>& p,
                           const Eigen::Ref<const Eigen::VectorXd>& q);

/// Returns the mean chi-square distance over the three planes.
double chi_square_distance(const BinaryPatterns& a, const BinaryPatterns& b);

}  // namespace emberfold::dytex
