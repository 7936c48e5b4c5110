// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <utility>
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

/// Where two parts of a component meet.
struct Joint {
  std::uint32_t label_a = 0, label_b = 0;  ///< a < b
  Point place;
  bool continues = false;  ///< the parts are one line with a gap in it, turning below 30° at both ends
};

/// Vertices that belong to a part: (vertex, label), a vertex perhaps to several parts.
using Labelled = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// For the parts of one component that hold labelled vertices, the shortest joints that hold them all
/// together, one fewer than there are labels. The vertices without a label are what lies between.
std::vector<Joint> joints(const AttributeGraph& graph, Paths& paths, const Labelled& labelled);

}  // namespace emberfold::graph::detail
