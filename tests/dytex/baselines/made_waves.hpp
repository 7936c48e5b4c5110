// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <complex>
#include <cstdint>
#include <functional>
#include <numbers>
#include <vector>

#include <opencv2/core.hpp>

#include "core/clip.hpp"
#include "core/rng.hpp"

// Textures that move, made for the tests of measures.
namespace emberfold::test {

inline core::Clip empty_clip(int width, int height) {
  core::Clip clip;
  clip.info.width = width, clip.info.height = height, clip.info.depth = CV_32F, clip.info.white = 255;
  return clip;
}

inline core::Clip white_noise(int width, int height, int frames, double deviation, std::uint64_t seed) {
  auto clip = empty_clip(width, height);
  core::Rng rng(seed);
  for (int t = 0; t < frames; ++t) {
    cv::Mat frame(height, width, CV_32F);
    for (auto& value : cv::Mat_<float>(frame)) value = static_cast<float>(128 + deviation * rng.normal());
    clip.frames.push_back(frame);
  }
  return clip;
}

// Waves that travel, each of its own length and direction, its amplitude changing by chance: a stationary
// texture, 64 x 64. `seed` is the sample's; the waves are always the same ones.
inline core::Clip waves(int frames, std::uint64_t seed) {
  constexpr int kSide = 64, kWaves = 120;
  struct Wave {
    std::vector<std::complex<double>> along_x, along_y;
    std::complex<double> turn, value;
    double power = 0;
  };
  core::Rng law(1), rng(seed);
  std::vector<Wave> all(kWaves);
  for (auto& wave : all) {
    const double frequency = law.uniform(0.03, 0.25), direction = law.uniform(-0.6, 0.6);
    wave.power = 20 * std::exp(-frequency * 8);
    wave.turn = std::polar(0.97, -2 * std::numbers::pi * (0.04 + 0.4 * frequency));
    wave.value = {rng.normal(), rng.normal()};
    for (int i = 0; i < kSide; ++i) {
      wave.along_x.push_back(std::polar(1.0, 2 * std::numbers::pi * frequency * std::cos(direction) * i));
      wave.along_y.push_back(std::polar(1.0, 2 * std::numbers::pi * frequency * std::sin(direction) * i));
    }
  }
  auto clip = empty_clip(kSide, kSide);
  for (int t = 0; t < frames; ++t) {
    cv::Mat frame(kSide, kSide, CV_32F, cv::Scalar(128));
    for (auto& wave : all) {
      wave.value = wave.turn * wave.value +
                   std::sqrt(1 - 0.97 * 0.97) * std::complex<double>{rng.normal(), rng.normal()};
      for (int y = 0; y < kSide; ++y) {
        const auto row = std::sqrt(wave.power) * wave.value * wave.along_y[static_cast<std::size_t>(y)];
        for (int x = 0; x < kSide; ++x)
          frame.at<float>(y, x) +=
              static_cast<float>(row.real() * wave.along_x[static_cast<std::size_t>(x)].real() -
                                 row.imag() * wave.along_x[static_cast<std::size_t>(x)].imag());
      }
    }
    for (auto& value : cv::Mat_<float>(frame)) value = std::round(value);
    clip.frames.push_back(frame);
  }
  return clip;
}

inline core::Clip changed(const core::Clip& clip, const std::function<cv::Mat(std::size_t)>& frame) {
  core::Clip out{clip.info, {}};
  for (std::size_t t = 0; t < clip.frames.size(); ++t) out.frames.push_back(frame(t));
  return out;
}

}  // namespace emberfold::test
