// SPDX-License-Identifier: Apache-2.0
#include "apps/builtin/line_drawing.hpp"

#include <algorithm>
#include <cmath>

namespace emberfold::apps {

namespace {

void draw_segment(cv::Mat& field, const Dab& a, const Dab& b) {
  const double reach = 3.6 * std::max(a.sigma, b.sigma);
  const int left = std::max(0, static_cast<int>(std::ceil(std::min(a.at.x, b.at.x) - reach)));
  const int right = std::min(field.cols - 1, static_cast<int>(std::floor(std::max(a.at.x, b.at.x) + reach)));
  const int top = std::max(0, static_cast<int>(std::ceil(std::min(a.at.y, b.at.y) - reach)));
  const int bottom = std::min(field.rows - 1, static_cast<int>(std::floor(std::max(a.at.y, b.at.y) + reach)));
  const cv::Point2d along = b.at - a.at;
  const double squared = std::max(along.dot(along), 1e-9);
  for (int y = top; y <= bottom; ++y) {
    auto* row = field.ptr<float>(y);
    for (int x = left; x <= right; ++x) {
      const cv::Point2d p(x, y);
      const double s = std::clamp((p - a.at).dot(along) / squared, 0.0, 1.0);
      const cv::Point2d off = p - a.at - s * along;
      const double sigma = a.sigma + s * (b.sigma - a.sigma);
      const double value =
          (a.contrast + s * (b.contrast - a.contrast)) * std::exp(-off.dot(off) / (2 * sigma * sigma));
      row[x] = std::max(row[x], static_cast<float>(value));
    }
  }
}

}  // namespace

void draw_line(cv::Mat& field, const std::vector<Dab>& dabs) {
  for (std::size_t i = 1; i < dabs.size(); ++i)
    if (dabs[i - 1].contrast > 0 || dabs[i].contrast > 0) draw_segment(field, dabs[i - 1], dabs[i]);
}

}  // namespace emberfold::apps
