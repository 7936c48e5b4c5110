// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include <opencv2/core/mat.hpp>

#include "graph/patch.hpp"

namespace emberfold::sketch {

/// Where a pixel lies in a blob, and what of its levels shows there (graph::Patch).
class BlobShape {
 public:
  explicit BlobShape(const graph::Patch& blob);

  [[nodiscard]] double reach() const { return reach_; }  ///< px, radius of the disc
  /// Whether the disc holds the pixel at this offset from the blob's position.
  [[nodiscard]] bool holds(double dx, double dy) const { return dx * dx + dy * dy <= reach_ * reach_ + 1e-6; }
  /// Shares of left, middle and right; they add up to 1.
  struct Shares {
    double left, middle, right;
  };
  [[nodiscard]] Shares at(double dx, double dy) const;

 private:
  double reach_, sd_, cosine_, sine_;
};

/// The blob that shows least squares of the frame in the disc of this radius: the ramp's direction from luma,
/// the levels of each channel in closed form. `levels`: CV_32F, 1 or 3 channels; pixels outside the frame are
/// not there. `reach`: px, 1.5…12. O(reach²).
graph::Patch fit_blob(const cv::Mat& levels, cv::Point centre, double reach);

}  // namespace emberfold::sketch
