// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include <boost/graph/graph_traits.hpp>
#include <boost/graph/properties.hpp>
#include <boost/iterator/counting_iterator.hpp>
#include <boost/iterator/iterator_facade.hpp>
#include <boost/iterator/transform_iterator.hpp>
#include <boost/property_map/property_map.hpp>

#include "graph/motion_graph.hpp"

namespace emberfold::graph {

/// Lets the algorithms of the Boost Graph Library run on the links of a motion graph: a directed graph whose
/// vertices are the patches of all frames and whose edges lead from each frame to the next. It has no
/// circles. Models VertexListGraph, EdgeListGraph, AdjacencyGraph and BidirectionalGraph.
/// A vertex is described by the number of patches before it, in frames before and in its own; that is its
/// vertex_index too. Refers to the motion graph, and keeps 8 bytes a patch and 8 a link of its own.
class LinkGraph {
 public:
  struct Edge {
    std::uint32_t source = 0, target = 0;
    bool operator==(const Edge&) const = default;
  };

  /// Throws InputError as validate() does. O(n log n) in patches and links.
  explicit LinkGraph(const MotionGraph& motion);

  [[nodiscard]] std::size_t size() const { return first_out_.size() - 1; }
  [[nodiscard]] std::size_t links() const { return targets_.size(); }
  /// Returns the frame of a vertex. O(log frames).
  [[nodiscard]] std::size_t frame_of(std::uint32_t vertex) const;
  /// Returns the patch with its identities. O(log frames).
  [[nodiscard]] const Vertex& patch(std::uint32_t vertex) const;
  /// Returns the vertex of a patch of a frame by its index there.
  [[nodiscard]] std::uint32_t vertex(std::size_t frame, std::size_t index) const {
    return first_of_frame_[frame] + static_cast<std::uint32_t>(index);
  }
  /// Returns what a patch is linked with in the next frame, ascending.
  [[nodiscard]] std::span<const std::uint32_t> after(std::uint32_t v) const {
    return std::span(targets_).subspan(first_out_[v], first_out_[v + 1] - first_out_[v]);
  }
  /// Returns what a patch is linked with in the frame before, ascending.
  [[nodiscard]] std::span<const std::uint32_t> before(std::uint32_t v) const {
    return std::span(sources_).subspan(first_in_[v], first_in_[v + 1] - first_in_[v]);
  }

 private:
  const MotionGraph* motion_;
  std::vector<std::uint32_t> first_of_frame_;  // and the number of all patches
  std::vector<std::uint32_t> first_out_, targets_, first_in_, sources_;
};

namespace detail {

struct LinkTo {
  std::uint32_t from = 0;
  LinkGraph::Edge operator()(std::uint32_t to) const { return {from, to}; }
};
struct LinkFrom {
  std::uint32_t to = 0;
  LinkGraph::Edge operator()(std::uint32_t from) const { return {from, to}; }
};

/// Steps through the links of one vertex after the other.
class LinkIterator : public boost::iterator_facade<LinkIterator, LinkGraph::Edge, std::forward_iterator_tag,
                                                   LinkGraph::Edge> {
 public:
  LinkIterator() = default;
  LinkIterator(const LinkGraph& graph, std::uint32_t vertex) : graph_(&graph), vertex_(vertex) { settle(); }

 private:
  friend class boost::iterator_core_access;
  [[nodiscard]] LinkGraph::Edge dereference() const { return {vertex_, graph_->after(vertex_)[link_]}; }
  [[nodiscard]] bool equal(const LinkIterator& other) const {
    return vertex_ == other.vertex_ && link_ == other.link_;
  }
  void increment() {
    if (++link_ < graph_->after(vertex_).size()) return;
    link_ = 0, ++vertex_;
    settle();
  }
  void settle() {
    while (vertex_ < graph_->size() && graph_->after(vertex_).empty()) ++vertex_;
  }

  const LinkGraph* graph_ = nullptr;
  std::uint32_t vertex_ = 0;
  std::size_t link_ = 0;
};

}  // namespace detail

}  // namespace emberfold::graph

/// \cond
template <>
struct boost::graph_traits<emberfold::graph::LinkGraph> {
  struct traversal_category : boost::bidirectional_graph_tag,
                              boost::adjacency_graph_tag,
                              boost::vertex_list_graph_tag,
                              boost::edge_list_graph_tag {};
  using vertex_descriptor = std::uint32_t;
  using edge_descriptor = emberfold::graph::LinkGraph::Edge;
  using directed_category = boost::bidirectional_tag;
  using edge_parallel_category = boost::disallow_parallel_edge_tag;
  using vertices_size_type = std::size_t;
  using edges_size_type = std::size_t;
  using degree_size_type = std::size_t;
  using vertex_iterator = boost::counting_iterator<std::uint32_t>;
  using adjacency_iterator = const std::uint32_t*;
  using out_edge_iterator = boost::transform_iterator<emberfold::graph::detail::LinkTo, const std::uint32_t*,
                                                      edge_descriptor, edge_descriptor>;
  using in_edge_iterator = boost::transform_iterator<emberfold::graph::detail::LinkFrom, const std::uint32_t*,
                                                     edge_descriptor, edge_descriptor>;
  using edge_iterator = emberfold::graph::detail::LinkIterator;
  static vertex_descriptor null_vertex() { return ~std::uint32_t{0}; }
};

template <>
struct boost::graph_traits<const emberfold::graph::LinkGraph>
    : boost::graph_traits<emberfold::graph::LinkGraph> {};

template <>
struct boost::property_map<emberfold::graph::LinkGraph, boost::vertex_index_t> {
  using type = boost::typed_identity_property_map<std::uint32_t>;
  using const_type = type;
};
template <>
struct boost::property_map<const emberfold::graph::LinkGraph, boost::vertex_index_t>
    : boost::property_map<emberfold::graph::LinkGraph, boost::vertex_index_t> {};
/// \endcond

namespace emberfold::graph {

using LinkTraits = boost::graph_traits<LinkGraph>;

inline std::size_t num_vertices(const LinkGraph& g) {
  return g.size();
}
inline std::size_t num_edges(const LinkGraph& g) {
  return g.links();
}
inline std::pair<LinkTraits::vertex_iterator, LinkTraits::vertex_iterator> vertices(const LinkGraph& g) {
  return {LinkTraits::vertex_iterator(0), LinkTraits::vertex_iterator(static_cast<std::uint32_t>(g.size()))};
}
inline std::pair<LinkTraits::edge_iterator, LinkTraits::edge_iterator> edges(const LinkGraph& g) {
  return {{g, 0}, {g, static_cast<std::uint32_t>(g.size())}};
}
inline std::uint32_t source(const LinkGraph::Edge& edge, const LinkGraph&) {
  return edge.source;
}
inline std::uint32_t target(const LinkGraph::Edge& edge, const LinkGraph&) {
  return edge.target;
}
inline std::pair<const std::uint32_t*, const std::uint32_t*> adjacent_vertices(std::uint32_t v,
                                                                               const LinkGraph& g) {
  const auto all = g.after(v);
  return {all.data(), all.data() + all.size()};
}
inline std::pair<LinkTraits::out_edge_iterator, LinkTraits::out_edge_iterator> out_edges(std::uint32_t v,
                                                                                         const LinkGraph& g) {
  const auto all = g.after(v);
  return {{all.data(), {v}}, {all.data() + all.size(), {v}}};
}
inline std::pair<LinkTraits::in_edge_iterator, LinkTraits::in_edge_iterator> in_edges(std::uint32_t v,
                                                                                      const LinkGraph& g) {
  const auto all = g.before(v);
  return {{all.data(), {v}}, {all.data() + all.size(), {v}}};
}
inline std::size_t out_degree(std::uint32_t v, const LinkGraph& g) {
  return g.after(v).size();
}
inline std::size_t in_degree(std::uint32_t v, const LinkGraph& g) {
  return g.before(v).size();
}
inline std::size_t degree(std::uint32_t v, const LinkGraph& g) {
  return in_degree(v, g) + out_degree(v, g);
}

inline boost::typed_identity_property_map<std::uint32_t> get(boost::vertex_index_t, const LinkGraph&) {
  return {};
}
inline std::uint32_t get(boost::vertex_index_t, const LinkGraph&, std::uint32_t v) {
  return v;
}

}  // namespace emberfold::graph
