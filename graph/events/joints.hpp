// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/attribute_graph.hpp"

namespace emberfold::graph::detail {

/// Shortest paths along the edges of one graph, lengths in px. Kept for many searches: each touches only the
/// vertices that it reaches.
class Paths {
 public:
  explicit Paths(const AttributeGraph& graph);

  /// Searches from all sources at once; what they do not reach has no distance.
  void search(std::span<const std::uint32_t> sources);

  [[nodiscard]] double distance(std::uint32_t vertex) const { return distance_[vertex]; }
  /// The source that is nearest, ties to the one with the lower index.
  [[nodiscard]] std::uint32_t source(std::uint32_t vertex) const { return source_[vertex]; }
  /// The vertices reached, in order of distance.
  [[nodiscard]] std::span<const std::uint32_t> reached() const { return reached_; }
  /// From the vertex to its source.
  [[nodiscard]] std::vector<std::uint32_t> way(std::uint32_t vertex) const;

 private:
  const AttributeGraph& graph_;
  std::vector<double> distance_;
  std::vector<std::uint32_t> source_, from_, reached_, touched_;
};

/// The arc-length middle of a path.
Point middle(const AttributeGraph& graph, std::span<const std::uint32_t> path);

/// The middle of a component: of the longest of its shortest paths (exact where it is a tree).
/// `member`: any of its vertices, the same one each time for the same place.
Point component_middle(const AttributeGraph& graph, Paths& paths, std::uint32_t member);

/// Of each vertex whether it lies within 10 px, along the graph, of an end of a curve.
std::vector<bool> near_ends(const AttributeGraph& graph, Paths& paths);

/// px along a curve that tell the direction of its tip: three patches or so, that noise does not turn it.
constexpr double kTipReach = 15;
/// The direction in which a curve ends, a unit vector; `way` goes from its tip back into it. Zero where both
/// ends of the way are in one place.
Point tip_direction(std::span<const Point> way);

/// Where two parts of a component meet.
struct Joint {
  std::uint32_t label_a = 0, label_b = 0;  ///< a < b
  Point place;
  bool continues = false;  ///< the parts are one line with a gap in it, turning below 30° at both ends
};

/// A vertex that belongs to a part; perhaps to several parts.
struct Tie {
  std::uint32_t vertex = 0, label = 0;
  bool at_end = false;  ///< in the frame where the part stands alone, this is at one of its ends
};

/// For the parts of one component, given by the vertices that belong to them, the shortest joints that hold
/// them all together, one fewer than there are labels. The other vertices are what lies between.
std::vector<Joint> joints(const AttributeGraph& graph, Paths& paths, std::vector<Tie> ties);

}  // namespace emberfold::graph::detail
