// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "tests/support/clip_fixture.hpp"

namespace emberfold::test {

/// Returns the next frames of a synthesis.
template <class Synthesis>
std::vector<cv::Mat> draw(Synthesis& synthesis, int count) {
  std::vector<cv::Mat> frames;
  synthesis.each(count, [&](cv::Mat frame) { frames.push_back(std::move(frame)); });
  return frames;
}

inline bool same_frames(const std::vector<cv::Mat>& a, const std::vector<cv::Mat>& b) {
  return std::ranges::equal(a, b, same_pixels);
}

}  // namespace emberfold::test
