// SPDX-License-Identifier: Apache-2.0
#include "core/math/image_gradient.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace emberfold::core {

ImageGradient sobel(const cv::Mat& luma) {
  ImageGradient g;
  cv::Sobel(luma, g.x, CV_32F, 1, 0, 3, 1.0 / 8, 0, cv::BORDER_REPLICATE);
  cv::Sobel(luma, g.y, CV_32F, 0, 1, 3, 1.0 / 8, 0, cv::BORDER_REPLICATE);
  cv::magnitude(g.x, g.y, g.size);
  return g;
}

}  // namespace emberfold::core
