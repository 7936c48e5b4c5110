// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <memory>
#include <memory_resource>
#include <span>
#include <vector>

#include "graph/patch.hpp"

namespace emberfold::graph {

/// Identifies a patch; unique in its clip.
struct VertexId {
  std::uint32_t value = 0;
  auto operator<=>(const VertexId&) const = default;
};

/// Identifies a stroke (a connected subgraph) through time; unique in its clip. 0: not identified yet.
struct SubgraphId {
  std::uint32_t value = 0;
  auto operator<=>(const SubgraphId&) const = default;
};

/// Identifies a curve (a path through junctions and crossings) through time; unique in its clip. 0: not
/// identified yet.
struct CurveId {
  std::uint32_t value = 0;
  auto operator<=>(const CurveId&) const = default;
};

/// A patch with its identity and that of its stroke and its curve.
struct Vertex {
  VertexId id;
  SubgraphId subgraph;
  Patch patch;
  CurveId curve = {};
  bool operator==(const Vertex&) const = default;
};

/// An undirected edge between two vertices of one frame.
struct Edge {
  VertexId a, b;  ///< a < b
  auto operator<=>(const Edge&) const = default;
};

/// Memory that graphs lie in; null: the heap. Thread-safe.
using GraphMemory = std::shared_ptr<std::pmr::memory_resource>;

/// Holds the attribute graph G = ⟨V, E⟩ of one frame as an immutable value.
/// Vertices are sorted by id; edges are sorted, without loops or repeats. Algorithms address a vertex by its
/// index in vertices(). Copies look at the same memory, which lives as long as one of them; what is made of a
/// graph lies where that does.
class AttributeGraph {
 public:
  AttributeGraph() = default;
  /// Builds a graph from vertices and edges in any order, either end of an edge first.
  /// Throws InputError, naming the ids, for a repeated id or edge, a loop, an edge to a missing vertex or to
  /// an anchor, or a patch with a number that is not finite; and what the memory throws. O(n log n).
  AttributeGraph(std::vector<Vertex> vertices, std::vector<Edge> edges, GraphMemory memory = {});
  // A move is a copy: what was moved from still is the graph.
  AttributeGraph(const AttributeGraph&) = default;
  AttributeGraph& operator=(const AttributeGraph&) = default;
  ~AttributeGraph() = default;

  [[nodiscard]] std::span<const Vertex> vertices() const { return vertices_; }
  [[nodiscard]] std::span<const Edge> edges() const { return edges_; }
  [[nodiscard]] std::size_t size() const { return vertices_.size(); }
  [[nodiscard]] bool empty() const { return vertices_.empty(); }
  [[nodiscard]] const Patch& patch(std::size_t index) const { return vertices_[index].patch; }

  /// Returns the indices of the adjacent vertices, ascending.
  [[nodiscard]] std::span<const std::uint32_t> neighbours(std::size_t index) const;
  [[nodiscard]] std::size_t degree(std::size_t index) const { return neighbours(index).size(); }
  /// Returns the index of the vertex with this id, or size() if there is none. O(log n).
  [[nodiscard]] std::size_t index_of(VertexId id) const;

  /// Returns a copy with other stroke identities, one for each vertex in order.
  /// Throws InputError if their number differs from size().
  [[nodiscard]] AttributeGraph with_subgraphs(std::span<const SubgraphId> subgraphs) const;

  /// Returns a copy with other curve identities, one for each vertex in order; errors likewise.
  [[nodiscard]] AttributeGraph with_curves(std::span<const CurveId> curves) const;

  /// Returns a copy of the graph that lies in other memory.
  [[nodiscard]] AttributeGraph kept_in(GraphMemory memory) const;
  [[nodiscard]] const GraphMemory& memory() const { return memory_; }

  bool operator==(const AttributeGraph& other) const;

 private:
  /// Copies all parts into one block of `memory`; returns its vertices.
  std::span<Vertex> place(std::span<const Vertex> vertices, std::span<const Edge> edges,
                          std::span<const std::uint32_t> first_neighbour,
                          std::span<const std::uint32_t> neighbours, GraphMemory memory);

  std::span<const Vertex> vertices_;
  std::span<const Edge> edges_;
  std::span<const std::uint32_t>
      first_neighbour_;  // neighbours of i: [first_neighbour_[i], first_neighbour_[i + 1])
  std::span<const std::uint32_t> neighbours_;
  GraphMemory memory_;
  std::shared_ptr<const void> block_;  // that all of them lie in
};

/// Returns the strokes of a graph without its anchors; they keep their ids. Whatever links, counts or
/// measures strokes in graphs that may hold anchors begins with this. O(n).
AttributeGraph without_anchors(const AttributeGraph& graph);

/// Returns the vertices of a stroke, by index, ascending. O(n).
std::vector<std::uint32_t> vertices_of(const AttributeGraph& graph, SubgraphId stroke);

/// Returns the induced subgraph: the vertices that stay, by index, and the edges between them. O(n log n).
AttributeGraph induced_subgraph(const AttributeGraph& graph, const std::vector<bool>& stays);

/// The connected components of a graph without its anchors, numbered 0, 1, … by their lowest vertex index.
struct Components {
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::vector<std::uint32_t> of_vertex;  ///< number of each vertex's component; kNone of an anchor
  std::size_t count = 0;
};
/// Finds the connected components of a graph. O(n α(n)) in vertices and edges.
Components components(const AttributeGraph& graph);

/// A maximal path whose inner vertices have degree 2, as vertex indices in order.
/// A ring repeats its first vertex at the end; an isolated vertex is a curve of one, an anchor none. A vertex
/// of degree ≥ 3 ends every curve that meets it.
using Curve = std::vector<std::uint32_t>;
/// Splits a graph into its curves; each edge lies in exactly one.
/// Ordered by their lowest vertices: equal graphs give equal lists. O(n log n).
std::vector<Curve> curves(const AttributeGraph& graph);

/// Returns the length of all edges along which something is seen, px. O(n log n).
double seen_length(const AttributeGraph& graph);

}  // namespace emberfold::graph
