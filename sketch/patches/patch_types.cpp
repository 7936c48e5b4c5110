// SPDX-License-Identifier: Apache-2.0
#include "sketch/patches/patch_types.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace emberfold::sketch {

using graph::PatchType;

namespace {

constexpr double kSharp = 3;  // blurs that a bar's core is wide at least

PatchType by_profile(const graph::Patch& patch) {
  if (graph::on_step(patch)) return PatchType::step;
  if (patch.width >= kSharp * patch.blur) return PatchType::bar;
  return patch.contrast >= 0 ? PatchType::ridge : PatchType::valley;
}

/// The widest angle between neighbouring arms, and the least that two arms miss a straight line by.
struct Angles {
  double widest, off_straight;
};
Angles angles(std::vector<double> arms) {
  std::sort(arms.begin(), arms.end());
  Angles result{0, std::numbers::pi};
  for (std::size_t i = 0; i < arms.size(); ++i) {
    const double next = i + 1 < arms.size() ? arms[i + 1] : arms[0] + 2 * std::numbers::pi;
    result.widest = std::max(result.widest, next - arms[i]);
    for (std::size_t j = i + 1; j < arms.size(); ++j) {
      const double between = std::min(arms[j] - arms[i], 2 * std::numbers::pi - (arms[j] - arms[i]));
      result.off_straight = std::min(result.off_straight, std::numbers::pi - between);
    }
  }
  return result;
}

PatchType by_degree(const graph::Patch& patch, const std::vector<double>& arms) {
  if (arms.size() == 1) return PatchType::terminator;
  const Angles seen = angles(arms);
  if (arms.size() == 2)
    return seen.off_straight > std::numbers::pi / 3 ? PatchType::corner : by_profile(patch);
  if (arms.size() > 3) return PatchType::crossing;
  if (seen.off_straight < std::numbers::pi / 6) return PatchType::t_junction;
  return seen.widest > 7 * std::numbers::pi / 6 ? PatchType::l_junction : PatchType::y_junction;
}

}  // namespace

graph::AttributeGraph name_patch_types(std::vector<graph::Vertex> vertices, std::vector<graph::Edge> edges) {
  const graph::AttributeGraph graph(std::move(vertices), std::move(edges));
  std::vector<graph::Vertex> named(graph.vertices().begin(), graph.vertices().end());
  for (std::size_t i = 0; i < named.size(); ++i) {
    graph::Patch& patch = named[i].patch;
    std::vector<double> arms;
    for (const auto j : graph.neighbours(i)) {
      const graph::Point way = graph.patch(j).position - patch.position;
      arms.push_back(std::atan2(way.y, way.x));
    }
    patch.type = arms.empty() ? by_profile(patch) : by_degree(patch, arms);
  }
  return {std::move(named), {graph.edges().begin(), graph.edges().end()}};
}

}  // namespace emberfold::sketch
