// SPDX-License-Identifier: Apache-2.0
// Textures of known make, for the tests of what clusters and fills them.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/rng.hpp"

namespace emberfold::test {

/// Whole levels around `mean`: 0 smoothed grain, 1 stripes along x, 2 stripes along y, 3 fine grain, 4 grain
/// drawn out along x, 5 along y.
inline cv::Mat texture(cv::Size size, int kind, double mean, std::uint64_t seed) {
  core::Rng rng(seed);
  cv::Mat levels(size, CV_32F);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) levels.at<float>(y, x) = static_cast<float>(rng.normal());
  if (kind == 0) {
    cv::GaussianBlur(levels, levels, {}, 2);
    levels *= 150;
  } else if (kind >= 4) {
    cv::GaussianBlur(levels, levels, {}, kind == 4 ? 3 : 0.6, kind == 4 ? 0.6 : 3);
    levels *= 80;
  } else if (kind == 3) {
    levels *= 25;
  } else {
    levels *= 3;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        levels.at<float>(y, x) +=
            static_cast<float>(35 * std::sin((kind == 1 ? y : x) * std::numbers::pi / 3));
  }
  for (float& value : cv::Mat_<float>(levels))
    value = std::round(std::fmin(std::fmax(value + static_cast<float>(mean), 0.0F), 255.0F));
  return levels;
}

inline cv::Mat nothing(cv::Size size) {
  return cv::Mat(size, CV_8U, cv::Scalar(0));
}

/// Bands of held pixels, as strokes leave them.
inline cv::Mat bands(cv::Size size) {
  cv::Mat mask = nothing(size);
  cv::circle(mask, {size.width / 2, size.height / 2}, size.height / 3, 255, 3);
  cv::line(mask, {0, size.height / 4}, {size.width - 1, size.height / 2}, 255, 3);
  return mask;
}

/// Returns whether two pictures agree in every byte where the mask is set.
inline bool same_where_held(const cv::Mat& a, const cv::Mat& b, const cv::Mat& mask) {
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (mask.at<uchar>(y, x) != 0 && std::memcmp(a.ptr(y, x), b.ptr(y, x), a.elemSize()) != 0) return false;
  return true;
}

}  // namespace emberfold::test
