// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/attribute_graph.hpp"

namespace emberfold::graph::detail {

/// Finds shortest paths along the edges of one graph, lengths in px (Dijkstra 1959).
/// Keep it for many searches: each touches only the vertices that it reaches.
class ShortestPaths {
 public:
  explicit ShortestPaths(const AttributeGraph& graph);

  /// Searches from all sources at once; vertices out of reach have no distance. O(n log n) in those reached.
  void search(std::span<const std::uint32_t> sources);

  [[nodiscard]] double distance(std::uint32_t vertex) const { return distance_[vertex]; }
  /// Returns the nearest source; of several the one with the lowest index.
  [[nodiscard]] std::uint32_t source(std::uint32_t vertex) const { return source_[vertex]; }
  /// Returns the vertices reached, in order of distance.
  [[nodiscard]] std::span<const std::uint32_t> reached() const { return reached_; }
  /// Returns the path from the vertex to its source.
  [[nodiscard]] std::vector<std::uint32_t> path_to_source(std::uint32_t vertex) const;

 private:
  const AttributeGraph& graph_;
  std::vector<double> distance_;
  std::vector<std::uint32_t> source_, from_, reached_, touched_;
};

/// Returns the arc-length middle of a path.
Point path_middle(const AttributeGraph& graph, std::span<const std::uint32_t> path);

/// Returns the middle of a component: that of the longest of its shortest paths (exact in a tree).
/// `member`: one of its vertices; equal vertices give equal bits.
Point component_middle(const AttributeGraph& graph, ShortestPaths& paths, std::uint32_t member);
/// Returns the longest of a component's shortest paths, likewise.
std::vector<std::uint32_t> longest_path(ShortestPaths& paths, std::uint32_t member);

/// Marks the vertices that lie within 10 px, along the graph, of an end of a curve.
std::vector<bool> find_vertices_near_ends(const AttributeGraph& graph, ShortestPaths& paths);

/// Length of curve from which the direction of its tip is fitted, px: about three patches, so that the noise
/// of one does not turn it.
constexpr double kTipReach = 15;
/// Returns the unit direction in which a curve ends.
/// `way` leads from its tip back into it. Zero if both ends of the way coincide.
Point tip_direction(std::span<const Point> way);

/// A joint: the place where two parts of a component meet.
struct Joint {
  std::uint32_t label_a = 0, label_b = 0;  ///< a < b
  Point place;
  bool continues = false;  ///< the parts are one line with a gap in it, turning below 30° at both ends
  std::vector<std::uint32_t> path;  ///< from the one part to the other, both ends included
};

/// A vertex that belongs to a part; it may belong to several.
struct PartVertex {
  std::uint32_t vertex = 0, label = 0;
  bool at_end = false;  ///< at an end of the part in the frame where the part is a stroke of its own
};

/// Finds the shortest joints that connect the parts of one component: one fewer than there are labels.
/// Vertices without a label lie between the parts.
std::vector<Joint> find_joints(const AttributeGraph& graph, ShortestPaths& paths,
                               std::vector<PartVertex> vertices);

}  // namespace emberfold::graph::detail
