// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/rng.hpp"
#include "graph/attribute_graph.hpp"

namespace emberfold::bench {

/// Strokes of 20 patches, 5 px apart, one for each 60 × 100 px, at time `t`: each sways about its foot, the
/// tip by up to 6 px a frame, and its patches lie where they happen to be cut.
inline graph::AttributeGraph swaying(std::size_t count, double t) {
  constexpr std::size_t kPatches = 20;
  const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count) / kPatches)));
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (std::size_t stroke = 0; stroke < count / kPatches; ++stroke) {
    core::Rng rng(1, {static_cast<std::uint32_t>(stroke)});
    const double phase = rng.uniform(0, 6.283), speed = rng.uniform(0.1, 0.3), contrast = rng.uniform(30, 90);
    core::Rng cut(2, {static_cast<std::uint32_t>(stroke), static_cast<std::uint32_t>(t)});
    graph::Point at{60.0 * static_cast<double>(stroke % columns) + rng.uniform(0, 20),
                    100.0 * static_cast<double>(stroke / columns + 1)};
    double theta = -1.57;
    for (std::size_t k = 0; k < kPatches; ++k) {
      graph::Patch patch;
      patch.position = {at.x + 0.2 * cut.normal(), at.y + 0.2 * cut.normal()};
      patch.theta = theta;
      patch.width = 3;
      patch.blur = 1.2;
      patch.contrast = contrast * (1 + 0.05 * cut.normal());
      const auto id = static_cast<std::uint32_t>(vertices.size());
      vertices.push_back({{id}, {}, patch});
      if (k > 0) edges.push_back({{id - 1}, {id}});
      theta = -1.57 + 0.5 * std::sin(phase + speed * t + 0.15 * static_cast<double>(k));
      const double step = 5 + 0.3 * cut.normal();
      at = at + graph::Point{std::cos(theta), std::sin(theta)} * step;
    }
  }
  return {std::move(vertices), std::move(edges)};
}

}  // namespace emberfold::bench
