// SPDX-License-Identifier: Apache-2.0
// Curves that move, touch and cross, cut into patches anew in every frame; whose patch is whose is known.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "core/rng.hpp"
#include "graph/matching/match.hpp"
#include "tests/support/graphs.hpp"

namespace emberfold::test {

/// A curve: its points from end to end in frame t, dense, and how strong it is.
struct MovingCurve {
  std::function<std::vector<graph::Point>(int t)> points;
  double contrast = 40;
};

/// A straight curve of so many px that moves along a line and turns.
inline MovingCurve moving_line(graph::Point middle, graph::Point velocity, double angle, double length,
                               double contrast = 40, double spin = 0, double bend = 0) {
  return {[=](int t) {
            const double now = angle + spin * t;
            const graph::Point along{std::cos(now), std::sin(now)}, normal{-along.y, along.x};
            std::vector<graph::Point> points;
            for (double s = -length / 2; s <= length / 2; s += 0.5)
              points.push_back(middle + velocity * t + along * s + normal * (bend * s * s));
            return points;
          },
          contrast};
}

/// Frames of moving curves and their links as the match finds them.
struct TouchingCurves {
  static constexpr std::uint32_t kShared = ~std::uint32_t{0};
  graph::MotionGraph motion;
  std::vector<std::vector<std::uint32_t>> owner;  ///< of each frame's vertices; kShared: of two curves

  TouchingCurves(const std::vector<MovingCurve>& curves, int frames, std::uint64_t seed) {
    core::Rng rng(seed);
    graph::SketchSequence sketch{320, 240, 25, {}};
    for (int t = 0; t < frames; ++t) {
      Frame frame;
      std::vector<std::vector<std::uint32_t>> ids;
      owner.emplace_back();
      for (std::uint32_t k = 0; k < curves.size(); ++k) {
        ids.push_back(draw(frame, curves[k], t, rng));
        owner.back().insert(owner.back().end(), ids.back().size(), k);
      }
      for (std::size_t a = 0; a < ids.size(); ++a)
        for (std::size_t b = a + 1; b < ids.size(); ++b) join(frame, ids[a], ids[b]);
      for (const std::uint32_t v : gone_) frame.vertices[v].id.value = kShared;
      for (std::size_t v = owner.back().size(); v-- > 0;) {
        if (frame.vertices[v].id.value != kShared) continue;
        frame.vertices.erase(frame.vertices.begin() + static_cast<std::ptrdiff_t>(v));
        owner.back().erase(owner.back().begin() + static_cast<std::ptrdiff_t>(v));
      }
      gone_.clear();
      sketch.append(frame.graph());
    }
    graph::MatchOptions options;
    options.flicker = 0;
    motion = graph::match(sketch, options);
  }

 private:
  std::vector<std::uint32_t> gone_;  ///< patches that others took the place of

  static std::vector<std::uint32_t> draw(Frame& frame, const MovingCurve& curve, int t, core::Rng& rng) {
    const auto dense = curve.points(t);
    std::vector<graph::Point> points{dense.front()};
    double walked = rng.uniform(0, 3);
    for (std::size_t k = 1; k < dense.size(); ++k) {
      walked += graph::distance(dense[k - 1], dense[k]);
      if (walked < 6) continue;
      points.push_back(dense[k]);
      walked = 0;
    }
    if (graph::distance(points.back(), dense.back()) > 3) points.push_back(dense.back());
    for (graph::Point& p : points) p = p + graph::Point{0.2 * rng.normal(), 0.2 * rng.normal()};
    const std::uint32_t first = frame.line(points, curve.contrast);
    std::vector<std::uint32_t> ids;
    for (std::uint32_t k = 0; k < points.size(); ++k) {
      frame.vertices[first + k].patch.contrast *= 1 + 0.02 * rng.normal();
      ids.push_back(first + k);
    }
    return ids;
  }

  /// Joins two curves where they are near each other, as a sketch does: by an edge at a tip, by a common
  /// patch where they cross.
  void join(Frame& frame, std::vector<std::uint32_t>& a, std::vector<std::uint32_t>& b) {
    double least = std::numeric_limits<double>::infinity();
    std::size_t i = 0, j = 0;
    for (std::size_t p = 0; p < a.size(); ++p) {
      for (std::size_t q = 0; q < b.size(); ++q) {
        const double d =
            graph::distance(frame.vertices[a[p]].patch.position, frame.vertices[b[q]].patch.position);
        if (d < least) least = d, i = p, j = q;
      }
    }
    const auto is_tip = [](const auto& ids, std::size_t k) { return k == 0 || k + 1 == ids.size(); };
    const auto is_gone = [&](std::uint32_t v) { return std::ranges::find(gone_, v) != gone_.end(); };
    if (least > 5 || is_gone(a[i]) || is_gone(b[j])) return;
    if (is_tip(a, i) || is_tip(b, j)) return frame.edge(std::min(a[i], b[j]), std::max(a[i], b[j]));
    const std::uint32_t kept = a[i], taken = b[j];
    if (kept == taken) return;
    std::vector<graph::Edge> edges;
    for (graph::Edge edge : frame.edges) {
      if (edge.a.value == taken) edge.a.value = kept;
      if (edge.b.value == taken) edge.b.value = kept;
      if (edge.b < edge.a) std::swap(edge.a, edge.b);
      if (edge.a != edge.b && std::ranges::find(edges, edge) == edges.end()) edges.push_back(edge);
    }
    frame.edges = std::move(edges);
    gone_.push_back(taken);
    b[j] = kept;
    owner.back()[kept] = kShared;
  }
};

/// The curve that most patches of a frame's owner have; 0 if it has none.
inline std::uint32_t curve_of(const graph::MotionGraph& motion, const TouchingCurves& scene, std::size_t t,
                              std::uint32_t owner) {
  std::map<std::uint32_t, int> count;
  const auto vertices = motion.sketch.frames[t].vertices();
  for (std::size_t v = 0; v < vertices.size(); ++v)
    if (scene.owner[t][v] == owner) ++count[vertices[v].curve.value];
  const auto most = std::ranges::max_element(count, {}, [](const auto& entry) { return entry.second; });
  return most == count.end() ? 0 : most->first;
}

}  // namespace emberfold::test
