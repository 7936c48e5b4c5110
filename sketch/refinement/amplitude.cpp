// SPDX-License-Identifier: Apache-2.0
#include "sketch/refinement/amplitude.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "sketch/patches/profile_shape.hpp"

namespace emberfold::sketch {

using graph::Patch;
using graph::Point;

namespace {

constexpr double kStep = 0.5;                               // px between samples across
constexpr std::array kSamples{-2.5, -1.25, 0., 1.25, 2.5};  // px, samples along
constexpr double kLeastReach = 3, kMostReach = 12;          // px to each side
constexpr double kOfSlip = 0.02;           // of the amplitude, what a px of slip has to be worth
constexpr double kLeastDifference = 1e-3;  // grey levels

/// The weights of the channels that make the patch's own difference of levels 1.
std::array<double, 3> project_colours(const Patch& patch, int channels) {
  std::array<double, 3> weights{};
  double square = 0;
  for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
    const double left = double{patch.left[c]}, right = double{patch.right[c]};
    weights[c] = on_step(patch) ? right - left : double{patch.middle[c]} - 0.5 * (left + right);
    square += weights[c] * weights[c];
  }
  for (double& w : weights) w /= std::max(square, kLeastDifference * kLeastDifference);
  return weights;
}

double sample(const cv::Mat& levels, Point p, const std::array<double, 3>& weights) {
  const double x = std::clamp(p.x, 0.0, levels.cols - 1.0), y = std::clamp(p.y, 0.0, levels.rows - 1.0);
  const int left = static_cast<int>(x), top = static_cast<int>(y), channels = levels.channels();
  const int right = std::min(left + 1, levels.cols - 1), bottom = std::min(top + 1, levels.rows - 1);
  const double u = x - left, v = y - top;
  const auto *above = levels.ptr<float>(top), *below = levels.ptr<float>(bottom);
  double sum = 0;
  for (int c = 0; c < channels; ++c) {
    const auto at = [&](const float* row, int column) { return double{row[column * channels + c]}; };
    sum +=
        weights[static_cast<std::size_t>(c)] * ((1 - v) * ((1 - u) * at(above, left) + u * at(above, right)) +
                                                v * ((1 - u) * at(below, left) + u * at(below, right)));
  }
  return sum;
}

}  // namespace

double measure_amplitude(const cv::Mat& levels, const Patch& patch, double slip) {
  if (patch.type == graph::PatchType::blob) return 1;
  const ProfileShape shape(patch);
  const double reach = std::clamp(shape.half_width + 2 * shape.blur, kLeastReach, kMostReach) + 1;
  const auto weights = project_colours(patch, levels.channels());
  const Point along{std::cos(patch.theta), std::sin(patch.theta)}, across{-along.y, along.x};
  const int half = static_cast<int>(reach / kStep), slips = static_cast<int>(slip / kStep),
            all = half + slips;
  std::vector<double> seen;
  for (int i = -all; i <= all; ++i) {
    double sum = 0;
    for (const double s : kSamples)
      sum += sample(levels, patch.position + across * (i * kStep) + along * s, weights);
    seen.push_back(sum / static_cast<double>(kSamples.size()));
  }
  // Without its mean the profile is orthogonal to a constant level.
  std::vector<double> profile;
  double mean = 0;
  for (int i = -half; i <= half; ++i) {
    const auto reached = shape.at(i * kStep);
    profile.push_back(on_step(patch) ? reached.enter : reached.enter - reached.leave);
    mean += profile.back();
  }
  mean /= static_cast<double>(profile.size());
  double square = 0;
  for (double& p : profile) p -= mean, square += p * p;
  double best = -std::numeric_limits<double>::infinity();
  for (int shift = -slips; shift <= slips; ++shift) {
    double product = 0;
    for (std::size_t i = 0; i < profile.size(); ++i)
      product += profile[i] * seen[i + static_cast<std::size_t>(slips + shift)];
    best = std::max(best, product / square - kOfSlip * kStep * std::abs(shift));
  }
  return best;
}

}  // namespace emberfold::sketch
