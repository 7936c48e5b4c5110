// SPDX-License-Identifier: Apache-2.0
#include "sketch/background/patch_distance.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace emberfold::sketch {

void distance_from_patches(cv::Size size, const std::uint8_t* mask, const float* opacity, float* distance) {
  constexpr float far = 1e6F;
  const auto columns = static_cast<std::size_t>(size.width), rows = static_cast<std::size_t>(size.height);
  const std::size_t stride = columns + 2;  // with a border of one pixel
  std::vector<float> padded(stride * (rows + 2), far);
  for (std::size_t y = 0; y < rows; ++y)
    for (std::size_t x = 0, i = y * columns; x < columns; ++x, ++i)
      if (mask[i] != 0)
        padded[(y + 1) * stride + x + 1] =
            opacity == nullptr ? 0 : static_cast<float>(kBackgroundDistance) * (1 - opacity[i]);
  const auto pass = [&](float* at, const float* beside, const float* row) {
    *at = std::min(
        {*at, *beside + kStraightStep, row[0] + kStraightStep, std::min(row[-1], row[1]) + kSlantedStep});
  };
  for (std::size_t y = 1; y <= rows; ++y)
    for (std::size_t x = 1; x <= columns; ++x) {
      float* at = &padded[y * stride + x];
      pass(at, at - 1, at - stride);
    }
  for (std::size_t y = rows; y >= 1; --y)
    for (std::size_t x = columns; x >= 1; --x) {
      float* at = &padded[y * stride + x];
      pass(at, at + 1, at + stride);
    }
  for (std::size_t y = 0; y < rows; ++y)
    std::copy_n(&padded[(y + 1) * stride + 1], columns, distance + y * columns);
}

}  // namespace emberfold::sketch
