// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "graph/patch.hpp"

namespace emberfold::graph {

/// Names a patch, unique in its clip.
struct VertexId {
  std::uint32_t value = 0;
  auto operator<=>(const VertexId&) const = default;
};

/// Names a stroke (a connected subgraph) through time, unique in its clip. 0: not identified yet.
struct SubgraphId {
  std::uint32_t value = 0;
  auto operator<=>(const SubgraphId&) const = default;
};

struct Vertex {
  VertexId id;
  SubgraphId subgraph;
  Patch patch;
  bool operator==(const Vertex&) const = default;
};

struct Edge {
  VertexId a, b;  ///< a < b
  auto operator<=>(const Edge&) const = default;
};

/// G = ⟨V, E⟩ of one frame, a value: vertices sorted by id, undirected edges sorted, without loops or
/// repeats. Algorithms address vertices by their index in vertices(), which is stable as long as the value
/// is.
class AttributeGraph {
 public:
  AttributeGraph() = default;
  /// Takes vertices and edges in any order, either end first. InputError (names the ids) for an id twice, an
  /// edge to a vertex that is not there, a loop, an edge twice, or a patch with a non-finite number. O(n log
  /// n).
  AttributeGraph(std::vector<Vertex> vertices, std::vector<Edge> edges);

  [[nodiscard]] std::span<const Vertex> vertices() const { return vertices_; }
  [[nodiscard]] std::span<const Edge> edges() const { return edges_; }
  [[nodiscard]] std::size_t size() const { return vertices_.size(); }
  [[nodiscard]] bool empty() const { return vertices_.empty(); }
  [[nodiscard]] const Patch& patch(std::size_t index) const { return vertices_[index].patch; }

  /// Indices of the vertices that share an edge with this one, ascending.
  [[nodiscard]] std::span<const std::uint32_t> neighbours(std::size_t index) const;
  [[nodiscard]] std::size_t degree(std::size_t index) const { return neighbours(index).size(); }
  /// Index of the vertex with this id, or size() where there is none. O(log n).
  [[nodiscard]] std::size_t index_of(VertexId id) const;

  /// The same graph with other stroke identities, one for each vertex in order.
  [[nodiscard]] AttributeGraph with_subgraphs(std::span<const SubgraphId> subgraphs) const;

  bool operator==(const AttributeGraph& other) const {
    return vertices_ == other.vertices_ && edges_ == other.edges_;
  }

 private:
  std::vector<Vertex> vertices_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t>
      first_neighbour_;  // neighbours of i: [first_neighbour_[i], first_neighbour_[i + 1])
  std::vector<std::uint32_t> neighbours_;
};

/// Connected components: for each vertex the number of its component. Components are numbered 0, 1, … by
/// their lowest vertex index.
struct Components {
  std::vector<std::uint32_t> of_vertex;
  std::size_t count = 0;
};
Components components(const AttributeGraph& graph);

/// A maximal path whose inner vertices have degree 2, as vertex indices in order. A ring repeats its first
/// vertex at the end; an isolated vertex is a curve of one. A vertex of degree ≥ 3 ends every curve that
/// meets it.
using Curve = std::vector<std::uint32_t>;
/// All curves, each edge in exactly one; ordered by their lowest vertices, so the same graph gives the same
/// list.
std::vector<Curve> curves(const AttributeGraph& graph);

}  // namespace emberfold::graph
