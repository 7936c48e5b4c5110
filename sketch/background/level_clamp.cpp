// SPDX-License-Identifier: Apache-2.0
#include "sketch/background/level_clamp.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/math/luma.hpp"
#include "sketch/rendering/curve_bands.hpp"

namespace emberfold::sketch {

namespace {

/// Linear between the middles of cells; the outermost go on.
double interpolate_cells(const LevelCells& cells, const std::uint8_t* values, graph::Point place,
                         int channel) {
  const auto along = [](double p, int count) {
    const double cell = std::clamp((p + 0.5) / kLevelRangeCell - 0.5, 0.0, count - 1.0);
    const int first = std::min(static_cast<int>(cell), std::max(0, count - 2));
    return std::pair{first, cell - first};
  };
  const auto [x, u] = along(place.x, cells.columns);
  const auto [y, v] = along(place.y, cells.rows);
  const int right = std::min(x + 1, cells.columns - 1), below = std::min(y + 1, cells.rows - 1);
  const auto value = [&](int column, int row) {
    return static_cast<double>(values[(row * cells.columns + column) * cells.channels + channel]);
  };
  return (1 - v) * ((1 - u) * value(x, y) + u * value(right, y)) +
         v * ((1 - u) * value(x, below) + u * value(right, below));
}

double luma(const graph::Level& level) {
  return core::luma(double{level[0]}, double{level[1]}, double{level[2]});
}

double clamp_level(double level, const LevelCells& range, graph::Point place, int channel) {
  return std::clamp(level, interpolate_cells(range, range.low, place, channel),
                    interpolate_cells(range, range.high, place, channel));
}

/// Share of a line's contrast that is visible; the blur takes the rest.
double visible_share(const graph::Patch& patch) {
  return std::erf(patch.width / (2 * std::numbers::sqrt2 * std::max(patch.blur, sketch::kLeastBlur)));
}

void clamp_patch(graph::Patch& patch, const LevelCells& range) {
  const graph::Point aside =
      graph::Point{-std::sin(patch.theta), std::cos(patch.theta)} * sketch::profile_reach(patch);
  const bool step = graph::on_step(patch);
  const double share = visible_share(patch), before = luma(patch.right) - luma(patch.left);
  for (std::size_t c = 0; c < patch.left.size(); ++c) {
    const int channel = std::min(static_cast<int>(c), range.channels - 1);
    const double height = double{patch.middle[c]} - (double{patch.left[c]} + double{patch.right[c]}) / 2;
    const double left = clamp_level(double{patch.left[c]}, range, patch.position - aside, channel),
                 right = clamp_level(double{patch.right[c]}, range, patch.position + aside, channel),
                 sides = (left + right) / 2;
    const double core =
        step ? 0 : clamp_level(sides + share * height, range, patch.position, channel) - sides;
    patch.left[c] = static_cast<float>(left), patch.right[c] = static_cast<float>(right);
    patch.middle[c] = static_cast<float>(step || share < 1e-3 ? sides : sides + core / share);
  }
  const double after = luma(patch.right) - luma(patch.left);
  if (step && before != after) patch.contrast = after;
}

}  // namespace

graph::AttributeGraph clamp_levels(const graph::AttributeGraph& graph, const LevelCells& range) {
  std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  for (auto& vertex : vertices) clamp_patch(vertex.patch, range);
  return {std::move(vertices), {graph.edges().begin(), graph.edges().end()}};
}

}  // namespace emberfold::sketch
