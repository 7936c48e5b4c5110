// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/attribute_graph.hpp"

namespace emberfold::graph::detail {

constexpr std::uint32_t kNoIndex = ~std::uint32_t{0};

/// A path of a graph between junctions, without them: vertices of degree ≤ 2 in order.
struct Arc {
  std::vector<std::uint32_t> path;                            ///< at least one vertex
  std::uint32_t front_knot = kNoIndex, back_knot = kNoIndex;  ///< where it meets a knot; kNoIndex: a tip
  bool closed = false;  ///< a ring: the last vertex is joined with the first
};

/// An end of an arc at a knot.
struct Arm {
  std::uint32_t arc = 0;
  bool front = false;  ///< whether the arc's front is the end
};

/// A junction, or several that short arcs join: where lines cross, two junctions lie side by side.
struct Knot {
  std::vector<std::uint32_t> vertices;
  std::vector<Arm> arms;  ///< by arc, front first
};

/// A graph as arcs and knots; every vertex lies in one arc or one knot.
struct FrameArcs {
  const AttributeGraph* graph = nullptr;
  std::vector<Arc> arcs;
  std::vector<Knot> knots;
  std::vector<std::uint32_t> arc_of, index_of, knot_of;  ///< of each vertex; kNoIndex: in none

  explicit FrameArcs(const AttributeGraph& g);

  [[nodiscard]] Point at(std::uint32_t vertex) const { return graph->patch(vertex).position; }
  /// Returns the vertices of an arc from one of them on, up or down, at most `reach` px far; a ring is gone
  /// round once.
  [[nodiscard]] std::vector<std::uint32_t> way(std::uint32_t arc, std::uint32_t from, bool up,
                                               double reach) const;
  /// Returns the way from an end of an arc into it.
  [[nodiscard]] std::vector<std::uint32_t> way(const Arm& arm, double reach) const;
  /// Returns whether a path of at most `hops` edges joins two vertices.
  [[nodiscard]] bool near(std::uint32_t a, std::uint32_t b, int hops) const;
};

}  // namespace emberfold::graph::detail
