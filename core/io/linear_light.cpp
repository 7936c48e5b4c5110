// SPDX-License-Identifier: Apache-2.0
#include "core/io/linear_light.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace emberfold::io {

namespace {

template <typename Level>
cv::Mat converted(const cv::Mat& picture, std::size_t white) {
  std::vector<float> light(white + 1);
  for (std::size_t i = 0; i <= white; ++i)
    light[i] = static_cast<float>(linear_light(static_cast<double>(i) / static_cast<double>(white)));
  const int channels = picture.channels();
  cv::Mat linear(picture.size(), CV_32FC(channels));
  for (int y = 0; y < picture.rows; ++y) {
    const auto* from = picture.ptr<Level>(y);
    auto* to = linear.ptr<float>(y);
    for (int x = 0; x < picture.cols; ++x, from += channels, to += channels) {
      const float opacity = channels == 4 ? static_cast<float>(from[3]) / static_cast<float>(white) : 1;
      for (int c = 0; c < channels; ++c) to[c] = c == 3 ? opacity : light[from[c]] * opacity;
    }
  }
  return linear;
}

}  // namespace

double linear_light(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

cv::Mat to_linear_light(const cv::Mat& picture) {
  return picture.depth() == CV_16U ? converted<std::uint16_t>(picture, 65535)
                                   : converted<std::uint8_t>(picture, 255);
}

}  // namespace emberfold::io
