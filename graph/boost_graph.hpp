// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include <boost/graph/graph_traits.hpp>
#include <boost/graph/properties.hpp>
#include <boost/iterator/counting_iterator.hpp>
#include <boost/iterator/transform_iterator.hpp>
#include <boost/property_map/function_property_map.hpp>
#include <boost/property_map/property_map.hpp>

#include "graph/attribute_graph.hpp"

/// Lets the algorithms of the Boost Graph Library run on an attribute graph as it is, without a copy: it
/// models VertexListGraph, EdgeListGraph, AdjacencyGraph and BidirectionalGraph, all undirected. A vertex is
/// described by its index in vertices(), which is its vertex_index too; edge_lengths() are weights. Example:
///
///     std::vector<int> part(graph.size());
///     int parts = boost::connected_components(graph, part.data());
namespace emberfold::graph {

/// Describes an edge as it is walked along; both ways are the same edge.
struct PatchEdge {
  std::uint32_t source = 0, target = 0;  ///< indices of vertices
  friend bool operator==(const PatchEdge& a, const PatchEdge& b) {
    return (a.source == b.source && a.target == b.target) || (a.source == b.target && a.target == b.source);
  }
};

namespace detail {

/// Names the edge to a neighbour, or from it.
struct ToNeighbour {
  std::uint32_t from = 0;
  PatchEdge operator()(std::uint32_t neighbour) const { return {from, neighbour}; }
};
struct FromNeighbour {
  std::uint32_t to = 0;
  PatchEdge operator()(std::uint32_t neighbour) const { return {neighbour, to}; }
};

/// Names an edge by the indices of its ends.
struct EdgeOfIds {
  const AttributeGraph* graph = nullptr;
  PatchEdge operator()(const Edge& edge) const {
    return {static_cast<std::uint32_t>(graph->index_of(edge.a)),
            static_cast<std::uint32_t>(graph->index_of(edge.b))};
  }
};

}  // namespace detail

}  // namespace emberfold::graph

/// \cond
template <>
struct boost::graph_traits<emberfold::graph::AttributeGraph> {
  struct traversal_category : boost::bidirectional_graph_tag,
                              boost::adjacency_graph_tag,
                              boost::vertex_list_graph_tag,
                              boost::edge_list_graph_tag {};
  using vertex_descriptor = std::uint32_t;
  using edge_descriptor = emberfold::graph::PatchEdge;
  using directed_category = boost::undirected_tag;
  using edge_parallel_category = boost::disallow_parallel_edge_tag;
  using vertices_size_type = std::size_t;
  using edges_size_type = std::size_t;
  using degree_size_type = std::size_t;
  using vertex_iterator = boost::counting_iterator<std::uint32_t>;
  using adjacency_iterator = const std::uint32_t*;
  using out_edge_iterator = boost::transform_iterator<emberfold::graph::detail::ToNeighbour,
                                                      const std::uint32_t*, edge_descriptor, edge_descriptor>;
  using in_edge_iterator = boost::transform_iterator<emberfold::graph::detail::FromNeighbour,
                                                     const std::uint32_t*, edge_descriptor, edge_descriptor>;
  using edge_iterator =
      boost::transform_iterator<emberfold::graph::detail::EdgeOfIds, const emberfold::graph::Edge*,
                                edge_descriptor, edge_descriptor>;
  static vertex_descriptor null_vertex() { return ~std::uint32_t{0}; }
};

template <>
struct boost::graph_traits<const emberfold::graph::AttributeGraph>
    : boost::graph_traits<emberfold::graph::AttributeGraph> {};

template <>
struct boost::property_map<emberfold::graph::AttributeGraph, boost::vertex_index_t> {
  using type = boost::typed_identity_property_map<std::uint32_t>;
  using const_type = type;
};
template <>
struct boost::property_map<const emberfold::graph::AttributeGraph, boost::vertex_index_t>
    : boost::property_map<emberfold::graph::AttributeGraph, boost::vertex_index_t> {};
/// \endcond

namespace emberfold::graph {

using BoostTraits = boost::graph_traits<AttributeGraph>;

inline std::size_t num_vertices(const AttributeGraph& g) {
  return g.size();
}
inline std::size_t num_edges(const AttributeGraph& g) {
  return g.edges().size();
}
inline std::pair<BoostTraits::vertex_iterator, BoostTraits::vertex_iterator> vertices(
    const AttributeGraph& g) {
  return {BoostTraits::vertex_iterator(0),
          BoostTraits::vertex_iterator(static_cast<std::uint32_t>(g.size()))};
}
/// Lists every edge once. Dereferencing is O(log n).
inline std::pair<BoostTraits::edge_iterator, BoostTraits::edge_iterator> edges(const AttributeGraph& g) {
  const auto all = g.edges();
  return {{all.data(), {&g}}, {all.data() + all.size(), {&g}}};
}
inline std::uint32_t source(const PatchEdge& edge, const AttributeGraph&) {
  return edge.source;
}
inline std::uint32_t target(const PatchEdge& edge, const AttributeGraph&) {
  return edge.target;
}
inline std::pair<BoostTraits::adjacency_iterator, BoostTraits::adjacency_iterator> adjacent_vertices(
    std::uint32_t v, const AttributeGraph& g) {
  const auto all = g.neighbours(v);
  return {all.data(), all.data() + all.size()};
}
inline std::pair<BoostTraits::out_edge_iterator, BoostTraits::out_edge_iterator> out_edges(
    std::uint32_t v, const AttributeGraph& g) {
  const auto all = g.neighbours(v);
  return {{all.data(), {v}}, {all.data() + all.size(), {v}}};
}
inline std::pair<BoostTraits::in_edge_iterator, BoostTraits::in_edge_iterator> in_edges(
    std::uint32_t v, const AttributeGraph& g) {
  const auto all = g.neighbours(v);
  return {{all.data(), {v}}, {all.data() + all.size(), {v}}};
}
inline std::size_t out_degree(std::uint32_t v, const AttributeGraph& g) {
  return g.degree(v);
}
inline std::size_t in_degree(std::uint32_t v, const AttributeGraph& g) {
  return g.degree(v);
}
inline std::size_t degree(std::uint32_t v, const AttributeGraph& g) {
  return g.degree(v);
}

inline boost::typed_identity_property_map<std::uint32_t> get(boost::vertex_index_t, const AttributeGraph&) {
  return {};
}
inline std::uint32_t get(boost::vertex_index_t, const AttributeGraph&, std::uint32_t v) {
  return v;
}

/// Returns a readable property map of the lengths of the edges, px. Refers to the graph.
inline auto edge_lengths(const AttributeGraph& g) {
  return boost::make_function_property_map<PatchEdge, double>([&g](const PatchEdge& edge) {
    return distance(g.patch(edge.source).position, g.patch(edge.target).position);
  });
}

}  // namespace emberfold::graph
