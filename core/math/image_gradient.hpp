// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace emberfold::core {

/// The gradient of a frame at every pixel, CV_32F, levels/px.
struct ImageGradient {
  cv::Mat x, y, size;  ///< components and length
};

/// Computes the gradient by Sobel's kernels over 8, with replicated borders.
/// `luma`: CV_32F, one channel. O(pixels).
ImageGradient sobel(const cv::Mat& luma);

}  // namespace emberfold::core
