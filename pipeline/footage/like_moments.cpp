// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/like_moments.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/parallel.hpp"

namespace emberfold::pipeline {

namespace {

constexpr int kComparedSide = 80;       // px: larger pictures are reduced before they are compared
constexpr double kBlur = 1;             // px: small shifts count as no difference
constexpr int kMostHalf = 4;            // frames: about a quarter of a second of motion
constexpr int kShortestJump = 25;       // frames: shorter jumps repeat or skip recent frames
constexpr double kNoDifference = 0.05;  // share of the usual change below which frames count as equal
constexpr std::size_t kBestJumps = 20;

cv::Mat small_picture(const cv::Mat& frame) {
  const double factor = std::min(1.0, double(kComparedSide) / std::max(frame.cols, frame.rows));
  cv::Mat small, levels, smooth;
  const cv::Size size(std::max(1, static_cast<int>(std::lround(frame.cols * factor))),
                      std::max(1, static_cast<int>(std::lround(frame.rows * factor))));
  cv::resize(frame, small, size, 0, 0, cv::INTER_AREA);
  small.convertTo(levels, CV_32F);
  cv::GaussianBlur(levels, smooth, {}, kBlur);
  return smooth;
}

cv::Mat1f distances(const std::vector<cv::Mat>& footage, const core::Context& context) {
  const auto count = footage.size();
  std::vector<cv::Mat> pictures(count);
  core::parallel_for(count, context, [&](std::size_t i) { pictures[i] = small_picture(footage[i]); });
  cv::Mat1f distance(static_cast<int>(count), static_cast<int>(count), 0.F);
  core::parallel_for(count, context, [&](std::size_t i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double squares = cv::norm(pictures[i], pictures[j], cv::NORM_L2SQR);
      const auto numbers = static_cast<double>(pictures[i].total()) * pictures[i].channels();
      distance(static_cast<int>(i), static_cast<int>(j)) = static_cast<float>(std::sqrt(squares / numbers));
    }
  });
  for (int i = 0; i < distance.rows; ++i)
    for (int j = 0; j < i; ++j) distance(j, i) = distance(i, j);
  return distance;
}

float jump_cost(const cv::Mat1f& distance, int half, int a, int b) {
  double sum = 0;
  int pairs = 0;
  for (int d = -half; d <= half; ++d) {
    const int i = a + 1 + d, j = b + d;
    if (i < 0 || j < 0 || i >= distance.rows || j >= distance.rows) continue;
    sum += double{distance(i, j)};
    ++pairs;
  }
  return static_cast<float>(sum / pairs);
}

/// Returns whether the whole footage repeats after `lag` frames.
bool repeats_after(const cv::Mat1f& distance, int lag, double change) {
  double sum = 0;
  for (int i = 0; i + lag < distance.rows; ++i) sum += double{distance(i, i + lag)};
  return sum < kNoDifference * change * (distance.rows - lag);
}

}  // namespace

LikeMoments compare_moments(const std::vector<cv::Mat>& footage, const core::Context& context) {
  constexpr float none = std::numeric_limits<float>::infinity();
  LikeMoments moments;
  const int n = moments.frames = static_cast<int>(footage.size());
  moments.half = std::clamp(n / 6, 0, kMostHalf);
  moments.cost = cv::Mat1f(n, n, none);
  const auto distance = distances(footage, context);
  for (int i = 0; i + 1 < n; ++i) moments.change += double{distance(i, i + 1)} / std::max(1, n - 1);
  const int gap = std::min(kShortestJump, n / 4);
  std::vector<bool> is_period;
  for (int lag = 0; lag < gap; ++lag)
    is_period.push_back(lag > 0 && repeats_after(distance, lag, moments.change));
  std::vector<float> costs;
  for (int a = moments.half; a < n - moments.half; ++a)
    for (int b = moments.half; b < n - moments.half; ++b) {
      const int lag = std::abs(a + 1 - b);
      if (lag == 0 || (lag < gap && !is_period[static_cast<std::size_t>(lag)])) continue;
      costs.push_back(moments.cost(a, b) = jump_cost(distance, moments.half, a, b));
    }
  moments.best = none;
  if (costs.empty()) return moments;
  const auto few = std::min(kBestJumps, costs.size());
  std::ranges::partial_sort(costs, costs.begin() + static_cast<std::ptrdiff_t>(few));
  moments.best = 0;
  for (std::size_t i = 0; i < few; ++i) moments.best += double{costs[i]} / double(few);
  return moments;
}

}  // namespace emberfold::pipeline
