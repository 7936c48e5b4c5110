// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/time_front.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "core/rng.hpp"

namespace emberfold::pipeline {

namespace {

constexpr std::uint32_t kFrontStream = 0x66726f6e;  // of the random stream
constexpr int kWaves = 16;                          // enough for an approximately normal field
constexpr int kWaveCell = 8;                        // px between the places where the waves are summed

}  // namespace

TimeFront::TimeFront(double amplitude, double range, double rate, std::uint64_t seed, std::optional<int> loop)
    : amplitude_(amplitude) {
  constexpr double turn = 2 * std::numbers::pi;
  core::Rng rng(seed, {kFrontStream});
  const double frequency = amplitude > 0 ? rate / amplitude : 0;  // rad a frame: SD of offset' = rate
  for (int i = 0; i < kWaves; ++i) {
    Wave wave{rng.normal() / range, rng.normal() / range, rng.normal() * frequency, rng.uniform(0, turn)};
    if (loop) wave.t = turn * std::round(wave.t * *loop / turn) / *loop;
    waves_.push_back(wave);
  }
}

cv::Mat1f TimeFront::at(double n, cv::Size size, double most) const {
  // One cell more on each side, so that every pixel has neighbouring cells.
  cv::Mat1f cells(size.height / kWaveCell + 3, size.width / kWaveCell + 3);
  const double scale = most / 3 * std::sqrt(2.0 / kWaves);
  for (int i = 0; i < cells.rows; ++i)
    for (int j = 0; j < cells.cols; ++j) {
      double sum = 0;
      for (const auto& wave : waves_)
        sum +=
            std::cos(wave.x * (j - 1) * kWaveCell + wave.y * (i - 1) * kWaveCell + wave.t * n + wave.phase);
      cells(i, j) = static_cast<float>(std::clamp(scale * sum, -most, most));
    }
  // cv::resize would align the pictures' borders, not the places.
  cv::Mat1f offsets(size);
  for (int y = 0; y < size.height; ++y) {
    const int i = y / kWaveCell + 1;
    const float v = static_cast<float>(y % kWaveCell) / kWaveCell;
    for (int x = 0; x < size.width; ++x) {
      const int j = x / kWaveCell + 1;
      const float u = static_cast<float>(x % kWaveCell) / kWaveCell;
      offsets(y, x) = (1 - v) * ((1 - u) * cells(i, j) + u * cells(i, j + 1)) +
                      v * ((1 - u) * cells(i + 1, j) + u * cells(i + 1, j + 1));
    }
  }
  return offsets;
}

}  // namespace emberfold::pipeline
