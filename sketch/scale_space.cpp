// SPDX-License-Identifier: Apache-2.0
#include "sketch/scale_space.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace emberfold::sketch {

namespace {

cv::Mat1d gaussian_kernel(double sigma) {
  const int radius = std::max(1, static_cast<int>(std::ceil(4 * sigma)));
  return cv::getGaussianKernel(2 * radius + 1, sigma, CV_64F);
}

// Sum of squares of a 1-D kernel after convolving it with `difference`: the gain of white noise's variance.
double noise_gain(const cv::Mat1d& kernel, std::initializer_list<double> difference) {
  const std::vector<double> d(difference);
  const int n = kernel.rows, m = static_cast<int>(d.size());
  double sum = 0;
  for (int i = 0; i < n + m - 1; ++i) {
    double v = 0;
    for (int j = 0; j < m; ++j)
      if (i - j >= 0 && i - j < n) v += d[static_cast<std::size_t>(j)] * kernel(i - j, 0);
    sum += v * v;
  }
  return sum;
}

struct Bilinear {
  int x, y;
  double fx, fy;
};

Bilinear locate(graph::Point p, int width, int height) {
  const double x = std::clamp(p.x, 0.0, width - 1.0), y = std::clamp(p.y, 0.0, height - 1.0);
  const int ix = std::min(static_cast<int>(x), std::max(width - 2, 0)),
            iy = std::min(static_cast<int>(y), std::max(height - 2, 0));
  return {ix, iy, x - ix, y - iy};
}

}  // namespace

Hessian ScaleLevel::hessian_at(graph::Point p) const {
  const int width = smooth.cols - 2, height = smooth.rows - 2;
  const Bilinear b = locate(p, width, height);
  const int x1 = std::min(b.x + 1, width - 1), y1 = std::min(b.y + 1, height - 1);
  const Hessian h00 = hessian(b.x, b.y), h10 = hessian(x1, b.y), h01 = hessian(b.x, y1),
                h11 = hessian(x1, y1);
  const auto mix = [&](float v00, float v10, float v01, float v11) {
    return static_cast<float>((1 - b.fy) * ((1 - b.fx) * double{v00} + b.fx * double{v10}) +
                              b.fy * ((1 - b.fx) * double{v01} + b.fx * double{v11}));
  };
  return {mix(h00.xx, h10.xx, h01.xx, h11.xx), mix(h00.xy, h10.xy, h01.xy, h11.xy),
          mix(h00.yy, h10.yy, h01.yy, h11.yy)};
}

double ScaleLevel::value_at(graph::Point p) const {
  const Bilinear b = locate(p, smooth.cols - 2, smooth.rows - 2);
  const float* upper = smooth[b.y + 1] + b.x + 1;
  const float* lower = smooth[b.y + 2] + b.x + 1;
  return (1 - b.fy) * ((1 - b.fx) * double{upper[0]} + b.fx * double{upper[1]}) +
         b.fy * ((1 - b.fx) * double{lower[0]} + b.fx * double{lower[1]});
}

ScaleSpace scale_space(const cv::Mat1f& luma, double finest, int levels) {
  ScaleSpace space;
  cv::Mat1f previous = luma;
  double previous_sigma = 0;
  for (int i = 0; i < levels; ++i) {
    ScaleLevel level;
    level.sigma = finest * std::pow(2.0, 0.5 * i);
    // Each level smooths the one before, which is cheaper than starting from the image and gives the same
    // Gaussian.
    const cv::Mat1d step =
        gaussian_kernel(std::sqrt(level.sigma * level.sigma - previous_sigma * previous_sigma));
    cv::Mat1f smooth;
    cv::sepFilter2D(previous, smooth, CV_32F, step, step, {-1, -1}, 0,
                    cv::BORDER_REFLECT | cv::BORDER_ISOLATED);
    cv::copyMakeBorder(smooth, level.smooth, 1, 1, 1, 1, cv::BORDER_REFLECT | cv::BORDER_ISOLATED);
    const cv::Mat1d whole = gaussian_kernel(level.sigma);
    const double plain = noise_gain(whole, {1});
    level.gradient_sd = std::sqrt(plain * noise_gain(whole, {0.5, 0, -0.5}));
    level.hessian_sd = std::sqrt(plain * noise_gain(whole, {1, -2, 1}));
    previous = smooth;
    previous_sigma = level.sigma;
    space.push_back(std::move(level));
  }
  return space;
}

}  // namespace emberfold::sketch
