// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/rng.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::test {

/// A wavy upright stroke that drifts, from its first to its last frame; it may come apart in its middle half
/// way through its life.
struct MadeStroke {
  int first = 0, last = 0, patches = 12;
  double x = 0, y = 0, drift = 0, phase = 0;
  bool comes_apart = false;

  [[nodiscard]] int apart_from() const { return comes_apart ? (first + last) / 2 + 1 : last + 1; }
};

inline std::vector<MadeStroke> made_strokes(int count, int width, int height, int frames,
                                            std::uint64_t seed = 1) {
  core::Rng rng(seed);
  std::vector<MadeStroke> strokes;
  for (int i = 0; i < count; ++i) {
    MadeStroke s;
    s.first = rng.uniform() < 0.4 ? 0 : static_cast<int>(rng.uniform(0, frames * 0.7));
    s.last = std::min(frames - 1, s.first + 4 + static_cast<int>(rng.uniform(0, frames * 0.8)));
    s.comes_apart = i % 3 == 0;
    s.patches = 6 + static_cast<int>(rng.below(12));
    s.x = rng.uniform(0.08, 0.92) * width;
    s.y = rng.uniform(0.05, 0.5) * height;
    s.drift = rng.uniform(-0.35, 0.35);
    s.phase = rng.uniform(0, 6.28);
    strokes.push_back(s);
  }
  return strokes;
}

inline graph::Patch made_patch(const MadeStroke& s, int t, int k) {
  graph::Patch patch;
  const double wave = s.phase + k * 0.4 + t * 0.1;
  patch.position = {s.x + s.drift * t + 4 * std::sin(wave), s.y + 5 * k};
  patch.theta = std::atan2(5, 1.6 * std::cos(wave));
  patch.width = 3, patch.blur = 1, patch.contrast = 60;
  return patch;
}

/// The motion graph of such strokes, every patch linked to itself in the next frame, strokes identified.
inline graph::MotionGraph made_motion(const std::vector<MadeStroke>& strokes, int width, int height,
                                      int frames) {
  graph::MotionGraph motion;
  motion.sketch.width = width, motion.sketch.height = height;
  std::vector<std::vector<graph::VertexId>> last(strokes.size());
  std::uint32_t next = 0;
  for (int t = 0; t < frames; ++t) {
    std::vector<graph::Vertex> vertices;
    std::vector<graph::Edge> edges;
    std::vector<graph::Link> links;
    for (std::size_t i = 0; i < strokes.size(); ++i) {
      const auto& s = strokes[i];
      std::vector<graph::VertexId> own;
      for (int k = 0; t >= s.first && t <= s.last && k < s.patches; ++k) {
        const graph::VertexId id{next++};
        const bool gap = t >= s.apart_from() && k == s.patches / 2;
        if (k > 0 && !gap) edges.push_back({own.back(), id});
        if (!last[i].empty()) links.push_back({last[i][static_cast<std::size_t>(k)], id});
        own.push_back(id);
        vertices.push_back({id, {}, made_patch(s, t, k)});
      }
      last[i] = own;
    }
    motion.sketch.frames.emplace_back(std::move(vertices), std::move(edges));
    motion.links.push_back(std::move(links));
  }
  return graph::identify(std::move(motion));
}

/// Returns frame t of the strokes, drawn, CV_8UC3.
inline cv::Mat made_picture(const std::vector<MadeStroke>& strokes, int width, int height, int t) {
  constexpr int kShift = 4;
  const auto fixed = [](double v) { return cvRound(v * (1 << kShift)); };
  cv::Mat picture(height, width, CV_8UC3, cv::Scalar(20, 22, 40));
  for (const auto& s : strokes)
    for (int k = 1; t >= s.first && t <= s.last && k < s.patches; ++k) {
      if (t >= s.apart_from() && k == s.patches / 2) continue;
      const auto a = made_patch(s, t, k - 1).position, b = made_patch(s, t, k).position;
      cv::line(picture, {fixed(a.x), fixed(a.y)}, {fixed(b.x), fixed(b.y)}, {60, 150, 240}, 3, cv::LINE_AA,
               kShift);
    }
  cv::GaussianBlur(picture, picture, {}, 1.2);
  return picture;
}

}  // namespace emberfold::test
