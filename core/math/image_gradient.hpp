// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace emberfold::core {

/// A frame's gradient at every pixel, CV_32F, levels/px.
struct ImageGradient {
  cv::Mat x, y, size;
};

/// Computes Sobel's gradient, an eighth of its kernels; outside the frame its border goes on. `luma`: CV_32F,
/// one channel. O(pixels).
ImageGradient sobel(const cv::Mat& luma);

}  // namespace emberfold::core
