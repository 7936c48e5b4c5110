// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip/masked_source.hpp"
#include "core/io/read_options.hpp"

namespace emberfold::io {

/// Finds the motion of the whole picture relative to the clip's first frame, frame by frame. Its reference is
/// the mean of the previous frames, aligned, in which independent motion blurs out and still parts stay.
/// Method: Gauss-Newton on grey levels, from coarse to fine, with Tukey's weights (Lucas & Kanade 1981; Baker
/// & Matthews 2004, inverse compositional), so that a part that moves differently counts little.
class Stabilizer {
 public:
  explicit Stabilizer(Stabilize kind) : kind_(kind) {}

  /// Returns the motion of the next frame. `luma`: CV_32F; `mask`: CV_8U, where to look; empty: everywhere.
  core::CameraMotion follow(const cv::Mat& luma, const cv::Mat& mask);

 private:
  void remember(const cv::Mat& luma, const cv::Mat& mask);

  Stabilize kind_;
  core::CameraMotion last_;
  cv::Mat mean_, weight_;  ///< of the previous frames, aligned; number of frames seen at a pixel
};

/// Returns the 2 × 3 matrix from pixels of the stabilized frame to those of the frame as stored.
cv::Mat warp_matrix(const core::CameraMotion& motion, cv::Size size);

}  // namespace emberfold::io
