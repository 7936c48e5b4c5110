// SPDX-License-Identifier: Apache-2.0
#include "pipeline/figures/left_squares.hpp"

#include <algorithm>

#include <opencv2/core.hpp>

namespace emberfold::pipeline {

LeftSquares left_squares(const cv::Mat1f& level, const cv::Mat1f& label, const cv::Mat1b& counts) {
  cv::Matx33d normal = cv::Matx33d::zeros();
  cv::Vec3d of_levels(0, 0, 0), of_labels(0, 0, 0), slope, shape;
  double levels = 0, labels = 0, shared = 0;
  for (int y = 0; y < level.rows; ++y)
    for (int x = 0; x < level.cols; ++x) {
      if (counts(y, x) == 0) continue;
      const cv::Vec3d v(1, x, y);
      const double l = level(y, x), m = label(y, x);
      normal += v * v.t();
      of_levels += v * l, of_labels += v * m;
      levels += l * l, labels += m * m, shared += l * m;
    }
  cv::solve(normal, of_levels, slope, cv::DECOMP_SVD);
  cv::solve(normal, of_labels, shape, cv::DECOMP_SVD);
  // What the plane leaves of the levels, of the label, and of their product.
  const double left = std::max(0., levels - slope.dot(of_levels));
  const double of_step = labels - shape.dot(of_labels), both = shared - shape.dot(of_levels);
  return {left, std::max(0., left - (of_step > 1e-6 ? both * both / of_step : 0))};
}

}  // namespace emberfold::pipeline
