// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/frame_likeness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "core/math/robust.hpp"

namespace emberfold::pipeline {

namespace {

constexpr int kWindow = 6, kSearch = 5;       // px of half the resolution, on each side
constexpr double kLeastContrast = 2;          // SD in grey levels
constexpr int kNeighbours = 3;                // pairs of neighbouring frames on each side of the change
constexpr std::array kFramesApart{6, 8, 10};  // frames

/// Returns the best correlation coefficient of the window around `centre` with the other frame; nothing if
/// the window is flat.
std::optional<double> best_correlation(const cv::Mat1f& of, const cv::Mat1f& with, cv::Point centre) {
  const cv::Rect frame(cv::Point(), of.size());
  const cv::Rect window(centre - cv::Point(kWindow, kWindow), cv::Size(2 * kWindow + 1, 2 * kWindow + 1));
  const cv::Rect searched = cv::Rect(window.tl() - cv::Point(kSearch, kSearch),
                                     window.size() + cv::Size(2 * kSearch, 2 * kSearch)) &
                            frame;
  cv::Scalar mean, deviation;
  cv::meanStdDev(of(window), mean, deviation);
  if (deviation[0] < kLeastContrast) return std::nullopt;
  cv::Mat1f correlation;
  cv::matchTemplate(with(searched), of(window), correlation, cv::TM_CCOEFF_NORMED);
  double most = 0;
  cv::minMaxLoc(correlation, nullptr, &most);
  return most;
}

}  // namespace

std::optional<mcmc::FrameLikeness> measure_likeness(const FrameWindow& window, int at, graph::Point place,
                                                    int frames) {
  const cv::Size size = window.halved(at).size();
  if (size.width <= 2 * kWindow || size.height <= 2 * kWindow) return std::nullopt;
  const cv::Point centre(
      std::clamp(static_cast<int>(std::lround(place.x / 2)), kWindow, size.width - 1 - kWindow),
      std::clamp(static_cast<int>(std::lround(place.y / 2)), kWindow, size.height - 1 - kWindow));
  std::vector<double> next, apart;
  const auto compare = [&](int from, int to, std::vector<double>& with) {
    if (from < 0 || to < 0 || from >= frames || to >= frames) return;
    if (const auto found = best_correlation(window.halved(from), window.halved(to), centre))
      with.push_back(*found);
  };
  for (int k = 0; k < kNeighbours; ++k) {
    compare(at - 1 - k, at - 2 - k, next);
    compare(at + k, at + k + 1, next);
  }
  for (const int frames_apart : kFramesApart) {
    compare(at - 1, at - 1 + frames_apart, apart);
    compare(at, at - frames_apart, apart);
  }
  if (next.size() < 2 || apart.empty()) return std::nullopt;
  return mcmc::FrameLikeness{core::median(next), core::median(apart)};
}

}  // namespace emberfold::pipeline
