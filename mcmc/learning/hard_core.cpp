// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/hard_core.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "graph/matching/point_grid.hpp"
#include "mcmc/simulation/rounding.hpp"

namespace emberfold::mcmc {

namespace {

using graph::Patch;
using graph::Point;

enum Kind : std::size_t { alike, lines, mixed, kinds };

Kind kind(const Patch& a, const Patch& b) {
  if (graph::on_step(a) != graph::on_step(b)) return mixed;
  return graph::same_kind(a, b) ? alike : lines;
}

// A patch beyond the end of a stroke does not lie beside it.
bool lies_beside(const Patch& patch, Point apart) {
  const Point along{std::cos(patch.theta), std::sin(patch.theta)};
  const double on = graph::dot(apart, along);
  return 2 * on * on <= graph::dot(apart, apart);
}

constexpr double farthest = 12;  // px
constexpr double step = 0.5;     // px, between the distances that are tried
constexpr std::size_t steps = static_cast<std::size_t>(farthest / step);
constexpr double rare_share = 0.2;
constexpr double kFewPatches = 20;  // patches
// Offsets to places nearby, px: out of reach, and unequal, so that regular folds of a cloth do not bias them.
constexpr std::array<Point, 6> elsewhere = {{{19, 7}, {-23, 9}, {-8, -27}, {31, -11}, {12, 33}, {-37, -14}}};

// Number of patches with one of another stroke within (k + 1) · step px, by kind.
using Counts = std::array<std::array<double, steps>, kinds>;

struct IndexedFrame {
  const graph::AttributeGraph& graph;
  graph::Components parts;
  graph::detail::PointGrid near;
};

IndexedFrame index_frame(const graph::AttributeGraph& graph) {
  std::vector<Point> places;
  for (const auto& vertex : graph.vertices()) places.push_back(vertex.patch.position);
  return {graph, graph::components(graph), {std::move(places), farthest}};
}

void count_near(const IndexedFrame& frame, Point shift, double weight, Counts& counts) {
  for (std::uint32_t v = 0; v < frame.graph.size(); ++v) {
    const Patch& patch = frame.graph.patch(v);
    const Point place = patch.position + shift;
    std::array<double, kinds> nearest{};
    nearest.fill(farthest);
    for (const auto w : frame.near.find_near(place)) {
      if (frame.parts.of_vertex[w] == frame.parts.of_vertex[v]) continue;
      const Patch& other = frame.graph.patch(w);
      if (!lies_beside(patch, other.position - place)) continue;
      double& least = nearest[kind(patch, other)];
      least = std::min(least, graph::distance(place, other.position));
    }
    for (std::size_t k = 0; k < kinds; ++k)
      for (auto s = static_cast<std::size_t>(nearest[k] / step); s < steps; ++s) counts[k][s] += weight;
  }
}

}  // namespace

double hard_core_distance(const HardCoreDistances& hard_core, const Patch& a, const Patch& b) {
  switch (kind(a, b)) {
    case alike:
      return hard_core.alike;
    case lines:
      return hard_core.lines;
    default:
      return hard_core.mixed;
  }
}

double largest_hard_core_distance(const HardCoreDistances& hard_core) {
  return std::max({hard_core.alike, hard_core.lines, hard_core.mixed});
}

HardCoreDistances estimate_hard_core(const graph::MotionGraph& motion) {
  Counts seen{}, expected{};
  for (const auto& graph : motion.sketch.frames) {
    const IndexedFrame frame = index_frame(graph);
    count_near(frame, {}, 1, seen);
    for (const Point shift : elsewhere) count_near(frame, shift, 1.0 / elsewhere.size(), expected);
  }
  std::array<double, kinds> result{};
  for (std::size_t k = 0; k < kinds; ++k)
    for (std::size_t s = 0; s < steps; ++s)
      if (expected[k][s] >= kFewPatches && seen[k][s] <= rare_share * expected[k][s])
        result[k] = static_cast<double>(s + 1) * step;
  return {result[alike], result[lines], result[mixed]};
}

namespace detail {

namespace {

constexpr int relaxations = 2, smoothings = 2;

// Offsets that move patches apart to the hard-core distance; each of two patches moves half the way.
std::vector<Point> separating_offsets(const SimulatedStrokes& p, const graph::Components& parts,
                                      const HardCoreDistances& hard_core) {
  std::vector<Point> places;
  for (const auto& simulated : p.list) places.push_back(simulated.position());
  const graph::detail::PointGrid near(places, largest_hard_core_distance(hard_core));
  std::vector<Point> result(p.list.size());
  for (std::uint32_t v = 0; v < p.list.size(); ++v) {
    if (p.list[v].frames_left >= 0) continue;
    double most = 0;
    for (const auto w : near.find_near(places[v])) {
      if (parts.of_vertex[w] == parts.of_vertex[v] || p.list[w].frames_left >= 0) continue;
      const Point apart = places[v] - places[w];
      const double far = graph::norm(apart),
                   missing = hard_core_distance(hard_core, p.list[v].rest, p.list[w].rest) - far;
      if (missing <= most || far <= 0 || !lies_beside(p.list[v].rest, apart)) continue;
      most = missing;
      result[v] = apart * (missing / 2 / far);
    }
  }
  return result;
}

}  // namespace

void enforce_hard_core(SimulatedStrokes& p, const MotionModel& model) {
  if (p.list.empty() || largest_hard_core_distance(model.hard_core) <= 0) return;
  const auto sides = neighbour_lists(p);
  const auto parts = graph::components(stroke_graph(p));
  for (int i = 0; i < relaxations; ++i) {
    auto push = separating_offsets(p, parts, model.hard_core);
    for (int k = 0; k < smoothings; ++k) {
      const auto now = push;
      for (std::size_t v = 0; v < now.size(); ++v) {
        const double share = 1 / static_cast<double>(1 + sides[v].size());
        push[v] = now[v] * share;
        for (const auto w : sides[v]) push[v] = push[v] + now[w] * share;
      }
    }
    for (std::size_t v = 0; v < push.size(); ++v)
      p.list[v].rest.position = p.list[v].rest.position + rounded(push[v]);
  }
}

}  // namespace detail

}  // namespace emberfold::mcmc
