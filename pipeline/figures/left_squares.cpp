// SPDX-License-Identifier: Apache-2.0
#include "pipeline/figures/left_squares.hpp"

#include <algorithm>

#include <opencv2/core.hpp>

namespace emberfold::pipeline {

double left_by_plane(const cv::Mat1f& level, const cv::Mat1b& counts) {
  cv::Matx33d normal = cv::Matx33d::zeros();
  cv::Vec3d moments(0, 0, 0), solution;
  double squares = 0;
  for (int y = 0; y < level.rows; ++y)
    for (int x = 0; x < level.cols; ++x) {
      if (counts(y, x) == 0) continue;
      const cv::Vec3d v(1, x, y);
      normal += v * v.t();
      moments += v * double(level(y, x));
      squares += double(level(y, x)) * level(y, x);
    }
  cv::solve(normal, moments, solution, cv::DECOMP_SVD);
  return std::max(0., squares - solution.dot(moments));
}

double left_by_figure(const cv::Mat1f& level, const cv::Mat1f& label, const cv::Mat1b& counts) {
  double n = 0, m = 0, mm = 0, l = 0, ll = 0, ml = 0;
  for (int y = 0; y < level.rows; ++y)
    for (int x = 0; x < level.cols; ++x) {
      if (counts(y, x) == 0) continue;
      const double a = label(y, x), b = level(y, x);
      ++n, m += a, mm += a * a, l += b, ll += b * b, ml += a * b;
    }
  const double spread = mm - m * m / n, shared = ml - m * l / n;
  return std::max(0., ll - l * l / n - (spread > 1e-6 ? shared * shared / spread : 0));
}

}  // namespace emberfold::pipeline
