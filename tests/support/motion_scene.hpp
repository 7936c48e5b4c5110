// SPDX-License-Identifier: Apache-2.0
// Motion graphs with known truth: curves at known places that move by a known law, sampled anew in every
// frame.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "core/rng.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::test {

using graph::Point;

/// d(t+1) = a1 d(t) + a2 d(t−1) + e, e of SD `noise`, at h px from each other correlated by exp(−h²/2
/// range²).
struct Law {
  double a1 = 0, a2 = 0, noise = 0, range = 30;
  /// SD in the stationary state, of an AR(2) (Box & Jenkins 1976, eq. 3.2.28).
  [[nodiscard]] double deviation() const {
    return noise * std::sqrt((1 - a2) / ((1 + a2) * ((1 - a2) * (1 - a2) - a1 * a1)));
  }
};

/// One realization along a curve: as many waves as it takes for their mean cosine to be the correlation,
/// each amplitude an AR(2) of its own.
class WaveMotion {
 public:
  WaveMotion() = default;
  WaveMotion(const Law& law, int frames, std::uint64_t seed, core::Stream stream) : range_(law.range) {
    core::Rng rng(seed, stream);
    std::vector<double> now(2 * kWaves), before(2 * kWaves);
    for (int t = -burn_in; t < frames; ++t) {
      std::vector<double> next(2 * kWaves);
      for (std::size_t k = 0; k < next.size(); ++k)
        next[k] = law.a1 * now[k] + law.a2 * before[k] + law.noise * rng.normal();
      before = std::exchange(now, std::move(next));
      if (t >= 0) frames_.push_back(now);
    }
  }
  [[nodiscard]] double at(double s, int t) const {
    if (frames_.empty()) return 0;
    const auto& amplitude = frames_[static_cast<std::size_t>(t)];
    double sum = 0;
    for (std::size_t k = 0; k < kWaves; ++k)
      sum +=
          amplitude[2 * k] * std::cos(frequency(k) * s) + amplitude[2 * k + 1] * std::sin(frequency(k) * s);
    return sum / std::sqrt(double(kWaves));
  }

 private:
  static constexpr std::size_t kWaves = 16;
  static constexpr int burn_in = 300;
  // Quantiles of N(0, 1/range²), whose characteristic function is the correlation.
  [[nodiscard]] double frequency(std::size_t k) const {
    static const auto quantiles = [] {
      std::vector<double> q;
      for (std::size_t i = 0; i < kWaves; ++i) {
        double low = -6, high = 6;
        while (high - low > 1e-12) {
          const double middle = (low + high) / 2;
          (0.5 * std::erfc(-middle / std::numbers::sqrt2) < (double(i) + 0.5) / kWaves ? low : high) = middle;
        }
        q.push_back(low);
      }
      return q;
    }();
    return quantiles[k] / range_;
  }
  double range_ = 1;
  std::vector<std::vector<double>> frames_;
};

/// A curve at rest: an arc of a circle, or a straight line where `bend` is 0.
struct Stroke {
  Point start;
  double theta = 0;   ///< rad, direction at the start
  double length = 0;  ///< px
  double bend = 0;    ///< 1/px, curvature
  double contrast = 40;
  int born = 0, dies = std::numeric_limits<int>::max();  ///< there in [born, dies)

  [[nodiscard]] double direction(double s) const { return theta + bend * s; }
  [[nodiscard]] Point at(double s) const {
    if (bend == 0) return start + Point{std::cos(theta), std::sin(theta)} * s;
    return start + Point{std::sin(direction(s)) - std::sin(theta), std::cos(theta) - std::cos(direction(s))} *
                       (1 / bend);
  }
  [[nodiscard]] Point normal(double s) const { return {-std::sin(direction(s)), std::cos(direction(s))}; }
};

struct Scene {
  int width = 320, height = 240, frames = 50;
  std::vector<Stroke> strokes;
  Law displacement, gain;             ///< of the displacement along the normal, px; of the log contrast
  std::function<Point(Point)> drift;  ///< px a frame, of a stroke by its start; none: at rest
  double jitter = 0;                  ///< px, SD: what each patch is off its curve, in each frame alone
  bool resampled = true;              ///< the patches' phase along the stroke is drawn anew in every frame
};

constexpr double spacing = 5;  // px

/// Place of a vertex.
struct Where {
  std::uint32_t stroke = 0;
  double s = 0;  ///< px along it
};

struct Made {
  graph::MotionGraph motion;                   ///< identified
  std::vector<std::vector<Where>> where;       ///< of each frame's vertices
  std::vector<WaveMotion> displacement, gain;  ///< of each stroke
};

inline Made make(const Scene& scene, std::uint64_t seed) {
  Made made;
  auto& sketch = made.motion.sketch;
  sketch.width = scene.width, sketch.height = scene.height;
  for (std::uint32_t i = 0; i < scene.strokes.size(); ++i) {
    made.displacement.emplace_back(scene.displacement, scene.frames, seed, core::Stream{i, 1, 0});
    made.gain.emplace_back(scene.gain, scene.frames, seed, core::Stream{i, 2, 0});
  }
  core::Rng rng(seed, {0, 3, 0});
  struct Run {
    double phase = 0;
    std::uint32_t first = 0, count = 0;  // vertices of the frame
  };
  std::vector<Run> before(scene.strokes.size());
  for (int t = 0; t < scene.frames; ++t) {
    std::vector<graph::Vertex> vertices;
    std::vector<graph::Edge> edges;
    std::vector<Run> now(scene.strokes.size());
    made.where.emplace_back();
    for (std::uint32_t i = 0; i < scene.strokes.size(); ++i) {
      const Stroke& stroke = scene.strokes[i];
      if (t < stroke.born || t >= stroke.dies) continue;
      const Point moved = scene.drift ? scene.drift(stroke.start) * double(t) : Point{};
      const double phase = scene.resampled ? rng.uniform(0, spacing) : spacing / 2;
      now[i] = {phase, static_cast<std::uint32_t>(vertices.size()), 0};
      const auto place = [&](double s) {
        return stroke.at(s) + stroke.normal(s) * made.displacement[i].at(s, t);
      };
      for (double s = phase; s <= stroke.length; s += spacing, ++now[i].count) {
        const Point ahead = place(s + 0.01) - place(s - 0.01);
        const double contrast = stroke.contrast * std::exp(made.gain[i].at(s, t));
        graph::Vertex v;
        v.id = {static_cast<std::uint32_t>(vertices.size())};
        v.patch.type = graph::PatchType::ridge;
        v.patch.position = place(s) + moved + stroke.normal(s) * (scene.jitter * rng.normal());
        v.patch.theta = std::atan2(ahead.y, ahead.x);
        v.patch.width = 2;
        v.patch.contrast = contrast;
        v.patch.left = v.patch.right = {100, 100, 100};
        v.patch.middle.fill(static_cast<float>(100 + contrast));
        if (now[i].count > 0) edges.push_back({{v.id.value - 1}, v.id});
        vertices.push_back(v);
        made.where.back().push_back({i, s});
      }
    }
    sketch.append({std::move(vertices), std::move(edges)});
    made.motion.links.emplace_back();
    if (t > 0) {
      const auto& a = sketch.frames[sketch.frames.size() - 2];
      const auto& b = sketch.frames.back();
      for (std::size_t i = 0; i < now.size(); ++i)
        for (std::uint32_t k = 0; k < before[i].count; ++k) {
          // The nearest along the stroke; both have the same spacing, so it is 1–1.
          const double s = before[i].phase + spacing * k;
          const auto j = std::lround((s - now[i].phase) / spacing);
          if (j < 0 || j >= static_cast<long>(now[i].count)) continue;
          made.motion.links.back().push_back({a.vertices()[before[i].first + k].id,
                                              b.vertices()[now[i].first + static_cast<std::uint32_t>(j)].id});
        }
      std::ranges::sort(made.motion.links.back());
    }
    before = std::move(now);
  }
  made.motion = graph::identify(std::move(made.motion));
  return made;
}

/// Curves evenly over the frame, of all directions, some bent.
inline std::vector<Stroke> scattered(int columns, int rows, int width, int height, double length) {
  std::vector<Stroke> strokes;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      Stroke s;
      const int number = r * columns + c;
      s.theta = number * 2.399963;  // rad: the golden angle
      s.length = length;
      s.bend = (number % 3 - 1) * 0.01;
      const Point middle{(c + 0.5) * width / columns, (r + 0.5) * height / rows};
      s.start = middle - (s.at(length / 2) - s.start);
      strokes.push_back(s);
    }
  return strokes;
}

/// Strokes that are born at `births` a frame, anywhere, and die at `death` a frame; what is there in frame 0
/// is as in the long run.
inline std::vector<Stroke> living(double births, double death, int frames, int width, int height,
                                  std::uint64_t seed) {
  core::Rng rng(seed, {0, 4, 0});
  std::vector<Stroke> strokes;
  const auto add = [&](int born) {
    Stroke s;
    s.theta = rng.uniform(0, 2 * std::numbers::pi);
    s.length = rng.uniform(30, 70);
    s.bend = rng.uniform(-0.015, 0.015);
    const Point middle{rng.uniform(0, width - 1.0), rng.uniform(0, height - 1.0)};
    s.start = middle - (s.at(s.length / 2) - s.start);
    s.contrast = rng.uniform(30, 60);
    s.born = born;
    // Ages at death are geometric.
    s.dies = born + 1 + static_cast<int>(std::log(1 - rng.uniform()) / std::log(1 - death));
    strokes.push_back(s);
  };
  for (int i = 0; i < static_cast<int>(std::lround(births / death)); ++i) add(0);
  for (int t = 1; t < frames; ++t) {
    double limit = std::exp(-births), product = rng.uniform();
    for (; product > limit; product *= rng.uniform()) add(t);
  }
  return strokes;
}

}  // namespace emberfold::test
