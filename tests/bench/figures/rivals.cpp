// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/figures/rivals.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "core/rng.hpp"

namespace emberfold::figures {

double psnr(const cv::Mat1b& frame, const cv::Mat& levels) {
  cv::Mat1f truth;
  frame.convertTo(truth, CV_32F);
  const double rms = cv::norm(truth, levels, cv::NORM_L2) / std::sqrt(static_cast<double>(frame.total()));
  return 20 * std::log10(255 / rms);
}

double share(const cv::Mat& mask) {
  return cv::countNonZero(mask) / static_cast<double>(mask.total());
}

cv::Mat canny_band(const cv::Mat1b& frame, double wanted) {
  cv::Mat smooth, edges, band, best;
  cv::GaussianBlur(frame, smooth, {}, 1);
  double low = 0, high = 2000;
  for (int i = 0; i < 30; ++i) {
    const double threshold = (low + high) / 2;
    cv::Canny(smooth, edges, 0.4 * threshold, threshold, 3, true);
    cv::dilate(edges, band, cv::Mat::ones(3, 3, CV_8U));
    if (best.empty() || std::abs(share(band) - wanted) < std::abs(share(best) - wanted)) best = band.clone();
    (share(band) > wanted ? low : high) = threshold;
  }
  return best;
}

cv::Mat random_mask(cv::Size size, double wanted) {
  std::vector<int> order(static_cast<std::size_t>(size.area()));
  std::iota(order.begin(), order.end(), 0);
  core::Rng rng(1);
  cv::Mat1b mask(size, static_cast<unsigned char>(0));
  const auto count = static_cast<std::size_t>(std::lround(wanted * size.area()));
  for (std::size_t i = 0; i < count; ++i) {
    std::swap(order[i], order[i + rng.below(static_cast<std::uint32_t>(order.size() - i))]);
    mask(order[i] / size.width, order[i] % size.width) = 255;
  }
  return mask;
}

}  // namespace emberfold::figures
