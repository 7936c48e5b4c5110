// SPDX-License-Identifier: Apache-2.0
#include "pipeline/output/opacity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/io/linear_light.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::pipeline {

namespace {

constexpr int kMostFrames = 64;
constexpr double kQuietShare = 0.25;    // share of the pixels whose noise is taken as the clip's
constexpr double kNoises = 3;           // multiples of the noise that count as background
constexpr int kMostTolerance = 8;       // grey levels
constexpr double kMedianToSd = 1.4826;  // of a normal distribution's absolute deviations

std::uint8_t median_of(std::vector<std::uint8_t>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Moves a frame's level towards the background's by the tolerance.
std::size_t less_noise(int level, int ground, int tolerance) {
  const int apart = level - ground, kept = std::max(0, std::abs(apart) - tolerance);
  return static_cast<std::size_t>(apart > 0 ? ground + kept : ground - kept);
}

/// Returns the least opacity at which a colour in 0…1 over `ground` gives `value`.
double least_opacity(double value, double ground) {
  if (value > ground) return (value - ground) / (1 - ground);
  return value < ground ? (ground - value) / ground : 0;
}

cv::Mat in_colour(const cv::Mat& picture) {
  if (picture.channels() == 3) return picture;
  cv::Mat colour;
  cv::cvtColor(picture, colour, cv::COLOR_GRAY2BGR);
  return colour;
}

}  // namespace

Ground still_ground(const std::vector<cv::Mat>& footage) {
  if (footage.empty()) throw core::InputError("a footage without frames has no ground");
  const std::size_t frames = std::min<std::size_t>(footage.size(), kMostFrames);
  std::vector<const cv::Mat*> chosen;
  for (std::size_t i = 0; i < frames; ++i) chosen.push_back(&footage[i * footage.size() / frames]);
  Ground ground{cv::Mat(footage.front().size(), footage.front().type())};
  const int values = ground.levels.cols * ground.levels.channels();
  std::vector<std::uint8_t> deviations;
  std::vector<std::uint8_t> levels(frames);
  for (int y = 0; y < ground.levels.rows; ++y)
    for (int x = 0; x < values; ++x) {
      std::ranges::transform(chosen, levels.begin(),
                             [&](const cv::Mat* frame) { return frame->ptr<std::uint8_t>(y)[x]; });
      const std::uint8_t median = median_of(levels);
      ground.levels.ptr<std::uint8_t>(y)[x] = median;
      for (auto& level : levels) level = static_cast<std::uint8_t>(std::abs(int{level} - int{median}));
      deviations.push_back(median_of(levels));
    }
  const auto quiet =
      deviations.begin() + static_cast<std::ptrdiff_t>(kQuietShare * static_cast<double>(deviations.size()));
  std::nth_element(deviations.begin(), quiet, deviations.end());
  const double noise = kMedianToSd * std::max(1.0, static_cast<double>(*quiet));
  ground.tolerance = std::min(kMostTolerance, static_cast<int>(std::lround(kNoises * noise)));
  return ground;
}

cv::Mat with_opacity(const cv::Mat& frame, const Ground& ground, Light light) {
  if (frame.size() != ground.levels.size())
    throw core::InputError("the ground is " + core::size_text(ground.levels.size()) + " pixels, the frame " +
                           core::size_text(frame.size()));
  std::array<double, 256> scaled{};  // levels in the light in which colours are mixed
  for (std::size_t i = 0; i < scaled.size(); ++i)
    scaled[i] = light == Light::linear ? io::linear_light(double(i) / 255) : double(i) / 255;
  const cv::Mat colours = in_colour(frame), under = in_colour(ground.levels);
  cv::Mat made(frame.size(), light == Light::linear ? CV_32FC4 : CV_8UC4);
  for (int y = 0; y < frame.rows; ++y)
    for (int x = 0; x < frame.cols; ++x) {
      const auto& level = colours.at<cv::Vec3b>(y, x);
      const auto& below = under.at<cv::Vec3b>(y, x);
      std::array<double, 3> value{}, beneath{};
      double opacity = 0;
      for (int c = 0; c < 3; ++c) {
        const auto k = static_cast<std::size_t>(c);
        beneath[k] = scaled[below[c]];
        value[k] = scaled[less_noise(level[c], below[c], ground.tolerance)];
        opacity = std::max(opacity, least_opacity(value[k], beneath[k]));
      }
      if (light == Light::linear) {
        auto& out = made.at<cv::Vec4f>(y, x);
        for (int c = 0; c < 3; ++c) {
          const auto k = static_cast<std::size_t>(c);
          out[c] = static_cast<float>(std::max(0.0, value[k] - (1 - opacity) * beneath[k]));
        }
        out[3] = static_cast<float>(opacity);
        continue;
      }
      auto& out = made.at<cv::Vec4b>(y, x);
      // Rounded up, so that no colour has to be brighter than white or darker than black.
      const double steps = std::ceil(opacity * 255 - 1e-9);
      for (int c = 0; c < 3 && steps > 0; ++c) {
        const auto k = static_cast<std::size_t>(c);
        out[c] = cv::saturate_cast<std::uint8_t>(255 * (beneath[k] + (value[k] - beneath[k]) * 255 / steps));
      }
      if (steps <= 0) out = {0, 0, 0, 0};
      out[3] = static_cast<std::uint8_t>(steps);
    }
  return made;
}

}  // namespace emberfold::pipeline
