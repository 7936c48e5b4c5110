// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "graph/attribute_graph.hpp"

namespace emberfold::graph::detail {

/// A frame that is being changed: its graph, and what differs from that.
class Draft {
 public:
  explicit Draft(const AttributeGraph& graph) : base_(graph) {}

  /// Visits the vertices that are there now, those of the graph first.
  template <class Visit>
  void each_vertex(const Visit& visit) const {
    for (const Vertex& v : base_.vertices())
      if (!gone_.contains(v.id)) visit(v);
    for (const Vertex& v : added_)
      if (!gone_.contains(v.id)) visit(v);
  }
  template <class Visit>
  void each_edge(const Visit& visit) const {
    const auto stays = [&](const Edge& e) { return !gone_.contains(e.a) && !gone_.contains(e.b); };
    for (const Edge& e : base_.edges())
      if (stays(e) && !cut_.contains(e)) visit(e);
    for (const Edge& e : joined_)
      if (stays(e)) visit(e);
  }
  /// The new vertices have ids that no other has or had.
  void add(const Vertex& vertex) { added_.push_back(vertex); }
  void remove(VertexId id) { gone_.insert(id); }
  void join(const Edge& edge) {
    if (cut_.erase(edge) == 0 && !std::ranges::binary_search(base_.edges(), edge)) joined_.insert(edge);
  }
  void cut(const Edge& edge) {
    if (joined_.erase(edge) == 0) cut_.insert(edge);
  }

  [[nodiscard]] const AttributeGraph& base() const { return base_; }
  [[nodiscard]] AttributeGraph graph() const {
    std::vector<Vertex> vertices;
    std::vector<Edge> edges;
    each_vertex([&](const Vertex& v) { vertices.push_back(v); });
    each_edge([&](const Edge& e) { edges.push_back(e); });
    return {std::move(vertices), std::move(edges), base_.memory()};
  }

 private:
  AttributeGraph base_;
  std::set<VertexId> gone_;
  std::vector<Vertex> added_;
  std::set<Edge> cut_, joined_;
};

}  // namespace emberfold::graph::detail
