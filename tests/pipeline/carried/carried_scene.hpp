// SPDX-License-Identifier: Apache-2.0
// Bright lines that appear, drift and vanish on a soft ground, with their true graphs.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "core/rng.hpp"
#include "mcmc/simulation/linked_frames.hpp"
#include "tests/support/graphs.hpp"

namespace emberfold::test {

struct CarriedScene {
  std::vector<cv::Mat> frames;
  graph::MotionGraph strokes;
};

constexpr int kSceneWidth = 160, kSceneHeight = 120;

inline double scene_ground(int x, int y) {
  return 80 + 20 * std::sin(x / 40.0) + 20 * std::cos(y / 30.0);
}

/// A line of the scene: level, with its left end at (x, y), of so many patches 4 px apart.
struct SceneLine {
  int first = 0, last = 0;  // frames
  double x = 0, y = 0;
  std::uint32_t patches = 8;
};

inline std::vector<SceneLine> scene_lines(int frames) {
  std::vector<SceneLine> lines;
  core::Rng rng(3);
  for (int row = 0; row < 5; ++row)
    for (int t = -10 + 3 * row; t < frames; t += 24)
      lines.push_back({t, t + 16, 12 + double(rng.below(90)), 16.0 + 22 * row, 8 + rng.below(4)});
  return lines;
}

inline CarriedScene carried_scene(int frames, int channels = 1) {
  CarriedScene scene;
  mcmc::detail::LinkedFrames linked;
  const auto lines = scene_lines(frames);
  for (int t = 0; t < frames; ++t) {
    cv::Mat1d levels(kSceneHeight, kSceneWidth);
    for (int y = 0; y < levels.rows; ++y)
      for (int x = 0; x < levels.cols; ++x) levels(y, x) = scene_ground(x, y);
    std::vector<graph::Vertex> vertices;
    std::vector<graph::Edge> edges;
    for (std::uint32_t n = 0; n < lines.size(); ++n) {
      const auto& line = lines[n];
      if (t < line.first || t > line.last) continue;
      const double y = line.y + 0.25 * (t - line.first), right = line.x + 4.0 * (line.patches - 1);
      for (int py = 0; py < levels.rows; ++py)
        for (int px = 0; px < levels.cols; ++px) {
          const double beyond = std::max({0.0, line.x - px, px - right});
          levels(py, px) += 90 * std::exp(-(std::pow(py - y, 2) + beyond * beyond) / 4.5);
        }
      for (std::uint32_t i = 0; i < line.patches; ++i) {
        vertices.push_back(vertex(1 + 32 * n + i, line.x + 4.0 * i, y));
        if (i > 0) edges.push_back({{32 * n + i}, {1 + 32 * n + i}});
      }
    }
    linked.append({std::move(vertices), std::move(edges)});
    cv::Mat frame(levels.size(), CV_8UC(channels));
    for (int y = 0; y < frame.rows; ++y)
      for (int x = 0; x < frame.cols; ++x)
        for (int c = 0; c < channels; ++c)
          frame.ptr<std::uint8_t>(y)[x * channels + c] =
              cv::saturate_cast<std::uint8_t>(levels(y, x) - 10 * c);
    scene.frames.push_back(frame);
  }
  auto& sketch = linked.motion.sketch;
  sketch.width = kSceneWidth, sketch.height = kSceneHeight;
  scene.strokes = graph::identify(std::move(linked.motion));
  return scene;
}

}  // namespace emberfold::test
