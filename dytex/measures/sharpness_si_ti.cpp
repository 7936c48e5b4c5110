// SPDX-License-Identifier: Apache-2.0
#include "dytex/measures/sharpness_si_ti.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <opencv2/core.hpp>

#include "core/math/bilinear.hpp"
#include "core/math/image_gradient.hpp"
#include "dytex/measures/check_frames.hpp"

namespace emberfold::dytex {

namespace {

constexpr double kLeastGradient = 1;        // level/px: below it a crease is noise
constexpr int kStepReach = 8;               // px to either side, over which a step's height is measured
constexpr std::size_t kPixelsPerStep = 50;  // a frame's pixels for each step that counts

double deviation(const cv::Mat& values) {
  cv::Scalar mean, sd;
  cv::meanStdDev(values, mean, sd);
  return sd[0];
}

struct CreasePoint {
  int x, y;
  double steepness, height;
};

using core::sample_bilinear;
using core::sobel;
using detail::check_alike;
using detail::check_luma;

// Points where the gradient's magnitude is largest along its own direction.
std::vector<CreasePoint> crease_points(const core::ImageGradient& g) {
  std::vector<CreasePoint> points;
  for (int y = 2; y + 2 < g.size.rows; ++y)
    for (int x = 2; x + 2 < g.size.cols; ++x) {
      const double size = static_cast<double>(g.size.at<float>(y, x));
      if (size < kLeastGradient) continue;
      const double dx = static_cast<double>(g.x.at<float>(y, x)) / size,
                   dy = static_cast<double>(g.y.at<float>(y, x)) / size;
      // >= on one side alone: of two equal neighbours one is taken
      if (size > sample_bilinear(g.size, x + dx, y + dy) && size >= sample_bilinear(g.size, x - dx, y - dy))
        points.push_back({x, y, size, 0});
    }
  return points;
}

// Returns how much the levels change from where they stop falling to where they stop rising.
double step_height(const cv::Mat& luma, const core::ImageGradient& g, const CreasePoint& point) {
  const double dx = static_cast<double>(g.x.at<float>(point.y, point.x)) / point.steepness,
               dy = static_cast<double>(g.y.at<float>(point.y, point.x)) / point.steepness;
  const double middle = static_cast<double>(luma.at<float>(point.y, point.x));
  double height = 0;
  for (const int side : {-1, 1}) {
    double reached = middle;
    for (int i = 1; i <= kStepReach; ++i) {
      const double x = point.x + side * i * dx, y = point.y + side * i * dy;
      if (x < 0 || y < 0 || x >= luma.cols - 1 || y >= luma.rows - 1) break;
      const double level = sample_bilinear(luma, x, y);
      if (side * (level - reached) <= 0) break;
      reached = level;
    }
    height += std::abs(reached - middle);
  }
  return height;
}

}  // namespace

double spatial_information(const cv::Mat& luma) {
  check_luma(luma, "spatial information");
  if (luma.cols < 3 || luma.rows < 3) return 0;
  const cv::Mat slope = sobel(luma).size;
  // P.910 uses Sobel's kernels unscaled, 8 times the slope.
  return 8 * deviation(slope(cv::Rect(1, 1, luma.cols - 2, luma.rows - 2)));
}

double temporal_information(const cv::Mat& luma, const cv::Mat& before) {
  check_luma(luma, "temporal information");
  check_luma(before, "temporal information");
  check_alike(luma, before, "temporal information");
  return deviation(luma - before);
}

Sharpness crease_sharpness(const cv::Mat& luma) {
  check_luma(luma, "crease sharpness");
  const auto g = sobel(luma);
  auto points = crease_points(g);
  for (auto& point : points) point.height = step_height(luma, g, point);
  const auto most = std::max<std::size_t>(1, luma.total() / kPixelsPerStep);
  if (points.size() > most) {
    // stable: points of one height are taken in the order of the frame
    std::ranges::stable_sort(points, std::ranges::greater{}, &CreasePoint::height);
    points.resize(most);
  }
  Sharpness found;
  for (const auto& point : points) {
    if (point.height <= 0) continue;
    found.gradient += point.steepness;
    found.sharpness += point.steepness / point.height;
    ++found.points;
  }
  if (found.points > 0) found.gradient /= found.points, found.sharpness /= found.points;
  return found;
}

}  // namespace emberfold::dytex
