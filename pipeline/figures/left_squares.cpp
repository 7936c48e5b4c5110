// SPDX-License-Identifier: Apache-2.0
#include "pipeline/figures/left_squares.hpp"

#include <algorithm>

#include <opencv2/core.hpp>

namespace emberfold::pipeline {

LeftSquares left_squares(const cv::Mat1f& level, const std::array<cv::Mat1f, 2>& labels,
                         const cv::Mat1b& counts) {
  struct OfLabel {
    cv::Vec3d sum;
    double square = 0, with_level = 0;
  };
  cv::Matx33d normal = cv::Matx33d::zeros();
  cv::Vec3d of_levels, slope, shape;
  std::array<OfLabel, 2> of_labels;
  double square = 0;
  for (int y = 0; y < level.rows; ++y)
    for (int x = 0; x < level.cols; ++x) {
      if (counts(y, x) == 0) continue;
      const cv::Vec3d v(1, x, y);
      const double l = level(y, x);
      normal += v * v.t();
      of_levels += v * l;
      square += l * l;
      for (std::size_t k = 0; k < labels.size(); ++k) {
        const double m = labels[k](y, x);
        of_labels[k].sum += v * m;
        of_labels[k].square += m * m, of_labels[k].with_level += l * m;
      }
    }
  cv::solve(normal, of_levels, slope, cv::DECOMP_SVD);
  LeftSquares left{std::max(0., square - slope.dot(of_levels)), {}};
  for (std::size_t k = 0; k < labels.size(); ++k) {
    // Residuals of the label, and of its product with the levels, after the plane.
    cv::solve(normal, of_labels[k].sum, shape, cv::DECOMP_SVD);
    const double of_step = of_labels[k].square - shape.dot(of_labels[k].sum),
                 both = of_labels[k].with_level - shape.dot(of_levels);
    left.by_figures[k] = std::max(0., left.by_plane - (of_step > 1e-6 ? both * both / of_step : 0));
  }
  return left;
}

}  // namespace emberfold::pipeline
