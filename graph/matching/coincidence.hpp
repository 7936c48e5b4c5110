// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "graph/attribute_graph.hpp"
#include "graph/matching/point_grid.hpp"

namespace emberfold::graph {

/// Farthest that patches of one place of a stroke lie from each other, px.
inline constexpr double kCoincidence = 6;

/// Returns how far two patches lie apart, along and across the stroke together, px, if both may show the same
/// place of it: of one kind, at most 4.5 px apart along it, 3 px across and 0.6 rad in direction. Junctions
/// and corners need to be 4.5 px apart at most, whatever their kind.
std::optional<double> coincidence(const Patch& patch, const Patch& other);

/// Finds patches of a graph by what they coincide with. Refers to the graph.
class CoincidenceIndex {
 public:
  explicit CoincidenceIndex(const AttributeGraph& graph);

  /// Returns the vertex that may show the same place of a stroke; of several the nearest.
  [[nodiscard]] std::optional<std::uint32_t> find(const Patch& patch) const;
  /// Returns the vertices within kCoincidence px, ascending.
  [[nodiscard]] std::vector<std::uint32_t> find_near(Point p) const { return places_.find_near(p); }

 private:
  const AttributeGraph* graph_;
  detail::PointGrid places_;
};

}  // namespace emberfold::graph
