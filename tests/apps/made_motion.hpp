// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/rng.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::tests {

/// A clip of wavy upright strokes that drift, each with its own first and last frame; every third one comes
/// apart in its middle half way through its life.
struct MadeMotion {
  graph::MotionGraph motion;
  std::vector<cv::Mat> frames;  ///< CV_8UC3, what it might look like
};

struct MadeStroke {
  int first = 0, last = 0, parts = 1;
  double x = 0, y = 0, drift = 0, phase = 0;
  int patches = 0;
};

inline std::vector<MadeStroke> made_strokes(int count, int width, int height, int frames,
                                            std::uint64_t seed) {
  core::Rng rng(seed);
  std::vector<MadeStroke> strokes;
  for (int i = 0; i < count; ++i) {
    MadeStroke s;
    s.first = rng.uniform() < 0.4 ? 0 : static_cast<int>(rng.uniform(0, frames * 0.7));
    s.last = std::min(frames - 1, s.first + 4 + static_cast<int>(rng.uniform(0, frames * 0.8)));
    s.parts = i % 3 == 0 ? 2 : 1;
    s.patches = 6 + static_cast<int>(rng.below(12));
    s.x = rng.uniform(0.08, 0.92) * width;
    s.y = rng.uniform(0.05, 0.5) * height;
    s.drift = rng.uniform(-0.35, 0.35);
    s.phase = rng.uniform(0, 6.28);
    strokes.push_back(s);
  }
  return strokes;
}

inline MadeMotion made_motion(int width, int height, int frames, int count = 14, std::uint64_t seed = 1) {
  MadeMotion made;
  auto& sketch = made.motion.sketch;
  sketch.width = width, sketch.height = height, sketch.fps = 25;
  const auto strokes = made_strokes(count, width, height, frames, seed);
  std::vector<std::vector<graph::VertexId>> last(strokes.size());
  for (int t = 0; t < frames; ++t) {
    std::vector<graph::Vertex> vertices;
    std::vector<graph::Edge> edges;
    std::vector<graph::Link> links;
    std::uint32_t next = 0;
    for (const auto& frame : sketch.frames) next += static_cast<std::uint32_t>(frame.size());
    cv::Mat picture(height, width, CV_8UC3, cv::Scalar(20, 22, 40));
    for (std::size_t i = 0; i < strokes.size(); ++i) {
      const auto& s = strokes[i];
      std::vector<graph::VertexId> own;
      for (int k = 0; t >= s.first && t <= s.last && k < s.patches; ++k) {
        graph::Vertex vertex;
        vertex.id = {next++};
        auto& patch = vertex.patch;
        const double wave = s.phase + k * 0.4 + t * 0.1;
        patch.position = {s.x + s.drift * t + 4 * std::sin(wave), s.y + 5 * k};
        patch.theta = std::atan2(5, 1.6 * std::cos(wave));
        patch.width = 3, patch.blur = 1, patch.contrast = 60;
        const bool apart = s.parts == 2 && t > (s.first + s.last) / 2 && k == s.patches / 2;
        if (k > 0 && !apart) edges.push_back({own.back(), vertex.id});
        own.push_back(vertex.id);
        vertices.push_back(vertex);
        const cv::Point at(cvRound(patch.position.x), cvRound(patch.position.y));
        cv::circle(picture, at, 3, {60, 150, 240}, cv::FILLED, cv::LINE_AA);
      }
      for (std::size_t k = 0; k < own.size() && k < last[i].size(); ++k)
        links.push_back({last[i][k], own[k]});
      last[i] = own;
    }
    cv::GaussianBlur(picture, picture, {}, 1.2);
    made.frames.push_back(picture);
    sketch.frames.emplace_back(std::move(vertices), std::move(edges));
    made.motion.links.push_back(std::move(links));
  }
  made.motion = graph::identify(std::move(made.motion));
  return made;
}

}  // namespace emberfold::tests
