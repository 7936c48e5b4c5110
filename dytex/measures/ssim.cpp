// SPDX-License-Identifier: Apache-2.0
#include "dytex/measures/ssim.hpp"

#include <algorithm>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dytex/measures/check_frames.hpp"

namespace emberfold::dytex {

namespace {

// Wang et al. 2004, section III.C.
constexpr int kSide = 11;                 // px, side of a window
constexpr double kWindowDeviation = 1.5;  // px, SD of its Gaussian weights
constexpr double kC1 = 0.01 * 255 * 0.01 * 255, kC2 = 0.03 * 255 * 0.03 * 255;  // levels²
// Levels are measured from mid-grey, so that their squares lose few digits.
constexpr double kMiddle = 127.5;

}  // namespace

double structural_similarity(const cv::Mat& a, const cv::Mat& b) {
  detail::check_luma(a, "structural similarity");
  detail::check_luma(b, "structural similarity");
  detail::check_alike(a, b, "structural similarity");
  const auto odd = [](int length) { return std::min(kSide, length - 1 + length % 2); };
  const cv::Size window(odd(a.cols), odd(a.rows));
  const cv::Rect inside(window.width / 2, window.height / 2, a.cols - window.width + 1,
                        a.rows - window.height + 1);
  const auto smooth = [&](const cv::Mat& image) {
    cv::Mat out;
    cv::GaussianBlur(image, out, window, kWindowDeviation);
    return cv::Mat(out, inside);
  };
  cv::Mat p, q;
  a.convertTo(p, CV_64F, 1, -kMiddle);
  b.convertTo(q, CV_64F, 1, -kMiddle);
  const cv::Mat mean_p = smooth(p), mean_q = smooth(q), pp = smooth(p.mul(p)), qq = smooth(q.mul(q)),
                pq = smooth(p.mul(q));
  double sum = 0;
  for (int y = 0; y < inside.height; ++y)
    for (int x = 0; x < inside.width; ++x) {
      const double m = mean_p.at<double>(y, x), n = mean_q.at<double>(y, x);
      const double spread =
          std::max(0.0, pp.at<double>(y, x) - m * m) + std::max(0.0, qq.at<double>(y, x) - n * n);
      const double together = pq.at<double>(y, x) - m * n, u = m + kMiddle, v = n + kMiddle;
      sum += (2 * u * v + kC1) * (2 * together + kC2) / ((u * u + v * v + kC1) * (spread + kC2));
    }
  return sum / inside.area();
}

}  // namespace emberfold::dytex
