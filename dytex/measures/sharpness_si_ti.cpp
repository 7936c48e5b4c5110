// SPDX-License-Identifier: Apache-2.0
#include "dytex/measures/sharpness_si_ti.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/math/bilinear.hpp"
#include "core/math/image_gradient.hpp"

namespace emberfold::dytex {

namespace {

void check_luma(const cv::Mat& luma, const char* who) {
  if (luma.empty() || luma.type() != CV_32FC1)
    throw core::InputError(std::string(who) + ": a frame must be luma, one channel of 32-bit floats");
}

void check_alike(const cv::Mat& a, const cv::Mat& b, const char* who) {
  if (a.size() != b.size())
    throw core::InputError(std::string(who) + ": the frames are " + std::to_string(a.cols) + "x" +
                           std::to_string(a.rows) + " and " + std::to_string(b.cols) + "x" +
                           std::to_string(b.rows) + "; allowed is one size");
}

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

// Where the gradient is largest along its own direction.
std::vector<CreasePoint> crease_points(const core::ImageGradient& g) {
  constexpr double kLeast = 1;  // level/px
  std::vector<CreasePoint> points;
  for (int y = 2; y + 2 < g.size.rows; ++y)
    for (int x = 2; x + 2 < g.size.cols; ++x) {
      const double size = static_cast<double>(g.size.at<float>(y, x));
      if (size < kLeast) continue;
      const double dx = static_cast<double>(g.x.at<float>(y, x)) / size,
                   dy = static_cast<double>(g.y.at<float>(y, x)) / size;
      // >= on one side alone: of two equal neighbours one is taken
      if (size > sample_bilinear(g.size, x + dx, y + dy) && size >= sample_bilinear(g.size, x - dx, y - dy))
        points.push_back({x, y, size, 0});
    }
  return points;
}

// By how much the levels change from where they stop falling to where they stop rising.
double step_height(const cv::Mat& luma, const core::ImageGradient& g, const CreasePoint& point) {
  constexpr int kReach = 8;
  const double dx = static_cast<double>(g.x.at<float>(point.y, point.x)) / point.steepness,
               dy = static_cast<double>(g.y.at<float>(point.y, point.x)) / point.steepness;
  const double middle = static_cast<double>(luma.at<float>(point.y, point.x));
  double height = 0;
  for (const int side : {-1, 1}) {
    double reached = middle;
    for (int i = 1; i <= kReach; ++i) {
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

double mean_square_error(const cv::Mat& a, const cv::Mat& b) {
  check_alike(a, b, "mean square error");
  if (a.empty() || a.type() != b.type() || a.depth() != CV_32F)
    throw core::InputError("mean square error: frames must have as many channels of 32-bit floats each");
  const double distance = cv::norm(a, b, cv::NORM_L2);
  return distance * distance / static_cast<double>(a.total() * static_cast<std::size_t>(a.channels()));
}

double psnr(double mean_square_error) {
  return mean_square_error > 0 ? std::min(kMostDecibel, 10 * std::log10(255.0 * 255.0 / mean_square_error))
                               : kMostDecibel;
}

double structural_similarity(const cv::Mat& a, const cv::Mat& b) {
  check_luma(a, "structural similarity");
  check_luma(b, "structural similarity");
  check_alike(a, b, "structural similarity");
  const auto odd = [](int length) { return std::min(11, length - 1 + length % 2); };
  const cv::Size window(odd(a.cols), odd(a.rows));
  const cv::Rect inside(window.width / 2, window.height / 2, a.cols - window.width + 1,
                        a.rows - window.height + 1);
  const auto smooth = [&](const cv::Mat& image) {
    cv::Mat out;
    cv::GaussianBlur(image, out, window, 1.5);
    return cv::Mat(out, inside);
  };
  // About mid-grey, so that squares lose little in 32 bits.
  constexpr double kMiddle = 127.5;
  cv::Mat p, q;
  a.convertTo(p, CV_64F, 1, -kMiddle);
  b.convertTo(q, CV_64F, 1, -kMiddle);
  const cv::Mat mean_p = smooth(p), mean_q = smooth(q), pp = smooth(p.mul(p)), qq = smooth(q.mul(q)),
                pq = smooth(p.mul(q));
  constexpr double c1 = 0.01 * 255 * 0.01 * 255, c2 = 0.03 * 255 * 0.03 * 255;
  double sum = 0;
  for (int y = 0; y < inside.height; ++y)
    for (int x = 0; x < inside.width; ++x) {
      const double m = mean_p.at<double>(y, x), n = mean_q.at<double>(y, x);
      const double spread =
          std::max(0.0, pp.at<double>(y, x) - m * m) + std::max(0.0, qq.at<double>(y, x) - n * n);
      const double together = pq.at<double>(y, x) - m * n, u = m + kMiddle, v = n + kMiddle;
      sum += (2 * u * v + c1) * (2 * together + c2) / ((u * u + v * v + c1) * (spread + c2));
    }
  return sum / inside.area();
}

double spatial_information(const cv::Mat& luma) {
  check_luma(luma, "spatial information");
  if (luma.cols < 3 || luma.rows < 3) return 0;
  const cv::Mat slope = sobel(luma).size;
  // P.910 has Sobel's kernels as they are, 8 times the slope.
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
  const auto most = std::max<std::size_t>(1, luma.total() / 50);
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
