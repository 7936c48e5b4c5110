// SPDX-License-Identifier: Apache-2.0
#include "graph/attribute_graph.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>

#include <boost/pending/disjoint_sets.hpp>

#include "core/error.hpp"

namespace emberfold::graph {

namespace {

std::string text(VertexId id) {
  return std::to_string(id.value);
}

bool is_finite(const Level& level) {
  return std::all_of(level.begin(), level.end(), [](float value) { return std::isfinite(value); });
}

bool is_finite(const Patch& p) {
  return std::isfinite(p.position.x) && std::isfinite(p.position.y) && std::isfinite(p.theta) &&
         std::isfinite(p.width) && std::isfinite(p.blur) && std::isfinite(p.contrast) &&
         std::isfinite(p.cost) && std::isfinite(p.gain) && std::isfinite(p.evidence) && is_finite(p.left) &&
         is_finite(p.middle) && is_finite(p.right);
}

/// Sorts the vertices; refuses repeated ids and numbers that are not finite.
void sort_vertices(std::vector<Vertex>& vertices) {
  const auto by_id = [](const Vertex& a, const Vertex& b) { return a.id < b.id; };
  if (!std::is_sorted(vertices.begin(), vertices.end(), by_id)) {
    std::sort(vertices.begin(), vertices.end(), by_id);
  }
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (i > 0 && vertices[i - 1].id == vertices[i].id) {
      throw core::InputError("attribute graph: vertex " + text(vertices[i].id) + " is there twice");
    }
    if (!is_finite(vertices[i].patch)) {
      throw core::InputError("attribute graph: the patch of vertex " + text(vertices[i].id) +
                             " holds a number that is not finite");
    }
  }
}

/// Sorts the edges and refuses loops and repeats.
void sort_edges(std::vector<Edge>& edges) {
  for (Edge& edge : edges) {
    if (edge.a == edge.b) {
      throw core::InputError("attribute graph: vertex " + text(edge.a) + " has an edge to itself");
    }
    if (edge.b < edge.a) std::swap(edge.a, edge.b);
  }
  if (!std::is_sorted(edges.begin(), edges.end())) std::sort(edges.begin(), edges.end());
  const auto twice = std::adjacent_find(edges.begin(), edges.end());
  if (twice != edges.end()) {
    throw core::InputError("attribute graph: the edge from vertex " + text(twice->a) + " to vertex " +
                           text(twice->b) + " is there twice");
  }
}

}  // namespace

AttributeGraph::AttributeGraph(std::vector<Vertex> vertices, std::vector<Edge> edges, GraphMemory memory) {
  sort_vertices(vertices);
  sort_edges(edges);
  vertices_ = vertices, edges_ = edges;  // until they are placed

  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends(edges.size());
  std::vector<std::uint32_t> first(vertices.size() + 1, 0);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto [a, b] = edges[e];
    const std::size_t i = index_of(a), j = index_of(b);
    if (i == size() || j == size()) {
      throw core::InputError("attribute graph: the edge from vertex " + text(a) + " to vertex " + text(b) +
                             " ends at vertex " + text(i == size() ? a : b) + ", which is not there");
    }
    if (is_anchor(patch(i)) || is_anchor(patch(j))) {
      throw core::InputError("attribute graph: the edge from vertex " + text(a) + " to vertex " + text(b) +
                             " ends at vertex " + text(is_anchor(patch(i)) ? a : b) +
                             ", an anchor, which has no edges");
    }
    ends[e] = {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)};
    ++first[i + 1];
    ++first[j + 1];
  }
  for (std::size_t i = 0; i < size(); ++i) first[i + 1] += first[i];

  // Edges are sorted by (a, b), so the lower neighbours of a vertex, filled first, and the higher ones come
  // out ascending.
  std::vector<std::uint32_t> neighbours(2 * edges.size());
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for (const auto& [i, j] : ends) neighbours[next[j]++] = i;
  for (const auto& [i, j] : ends) neighbours[next[i]++] = j;
  place(vertices, edges, first, neighbours, std::move(memory));
}

std::span<Vertex> AttributeGraph::place(std::span<const Vertex> vertices, std::span<const Edge> edges,
                                        std::span<const std::uint32_t> first_neighbour,
                                        std::span<const std::uint32_t> neighbours, GraphMemory memory) {
  static_assert(std::is_trivially_copyable_v<Vertex> && std::is_trivially_copyable_v<Edge>);
  static_assert(alignof(Vertex) >= alignof(Edge) && alignof(Edge) >= alignof(std::uint32_t));
  const std::size_t bytes =
      vertices.size_bytes() + edges.size_bytes() + first_neighbour.size_bytes() + neighbours.size_bytes();
  auto* const source = memory ? memory.get() : std::pmr::new_delete_resource();
  void* const block = source->allocate(bytes, alignof(Vertex));
  block_ = std::shared_ptr<const void>(
      block, [memory, source, bytes](void* given) { source->deallocate(given, bytes, alignof(Vertex)); });
  auto* end = static_cast<std::byte*>(block);
  const auto put = [&]<class T>(std::span<const T> values) {
    T* const at = reinterpret_cast<T*>(end);
    std::uninitialized_copy(values.begin(), values.end(), at);
    end += values.size_bytes();
    return std::span<T>(at, values.size());
  };
  const auto placed = put(vertices);
  vertices_ = placed, edges_ = put(edges);
  first_neighbour_ = put(first_neighbour), neighbours_ = put(neighbours);
  memory_ = std::move(memory);
  return placed;
}

bool AttributeGraph::operator==(const AttributeGraph& other) const {
  if (block_ == other.block_) return true;
  return std::ranges::equal(vertices_, other.vertices_) && std::ranges::equal(edges_, other.edges_);
}

AttributeGraph AttributeGraph::kept_in(GraphMemory memory) const {
  AttributeGraph result = *this;
  if (block_ != nullptr && memory != memory_)
    result.place(vertices_, edges_, first_neighbour_, neighbours_, std::move(memory));
  return result;
}

std::span<const std::uint32_t> AttributeGraph::neighbours(std::size_t index) const {
  const std::size_t first = first_neighbour_[index];
  return std::span(neighbours_).subspan(first, first_neighbour_[index + 1] - first);
}

std::size_t AttributeGraph::index_of(VertexId id) const {
  // Ids mostly count up without gaps.
  if (!vertices_.empty() && id >= vertices_.front().id) {
    const std::size_t guess = id.value - vertices_.front().id.value;
    if (guess < size() && vertices_[guess].id == id) return guess;
  }
  const auto found =
      std::lower_bound(vertices_.begin(), vertices_.end(), id,
                       [](const Vertex& vertex, VertexId wanted) { return vertex.id < wanted; });
  if (found == vertices_.end() || found->id != id) return size();
  return static_cast<std::size_t>(found - vertices_.begin());
}

AttributeGraph AttributeGraph::with_subgraphs(std::span<const SubgraphId> subgraphs) const {
  if (subgraphs.size() != size()) {
    throw core::InputError("attribute graph: " + std::to_string(subgraphs.size()) +
                           " stroke identities for " + std::to_string(size()) + " vertices");
  }
  AttributeGraph result;
  const auto changed = result.place(vertices_, edges_, first_neighbour_, neighbours_, memory_);
  for (std::size_t i = 0; i < size(); ++i) changed[i].subgraph = subgraphs[i];
  return result;
}

AttributeGraph AttributeGraph::with_curves(std::span<const CurveId> curves) const {
  if (curves.size() != size()) {
    throw core::InputError("attribute graph: " + std::to_string(curves.size()) + " curve identities for " +
                           std::to_string(size()) + " vertices");
  }
  AttributeGraph result;
  const auto changed = result.place(vertices_, edges_, first_neighbour_, neighbours_, memory_);
  for (std::size_t i = 0; i < size(); ++i) changed[i].curve = curves[i];
  return result;
}

AttributeGraph without_anchors(const AttributeGraph& graph) {
  const auto is_one = [](const Vertex& vertex) { return is_anchor(vertex.patch); };
  if (std::ranges::none_of(graph.vertices(), is_one)) return graph;
  std::vector<Vertex> strokes(graph.vertices().begin(), graph.vertices().end());
  std::erase_if(strokes, is_one);
  return {std::move(strokes), {graph.edges().begin(), graph.edges().end()}, graph.memory()};
}

std::vector<std::uint32_t> vertices_of(const AttributeGraph& graph, SubgraphId stroke) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t v = 0; v < graph.size(); ++v)
    if (graph.vertices()[v].subgraph == stroke) result.push_back(v);
  return result;
}

AttributeGraph induced_subgraph(const AttributeGraph& graph, const std::vector<bool>& stays) {
  std::vector<Vertex> vertices;
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < graph.size(); ++i)
    if (stays[i]) vertices.push_back(graph.vertices()[i]);
  for (const Edge& edge : graph.edges())
    if (stays[graph.index_of(edge.a)] && stays[graph.index_of(edge.b)]) edges.push_back(edge);
  return {std::move(vertices), std::move(edges), graph.memory()};
}

Components components(const AttributeGraph& graph) {
  const std::size_t n = graph.size();
  std::vector<std::size_t> rank(n), parent(n);
  boost::disjoint_sets sets(rank.data(), parent.data());
  for (std::size_t i = 0; i < n; ++i) sets.make_set(i);
  for (std::size_t i = 0; i < n; ++i) {
    for (const std::size_t j : graph.neighbours(i)) {
      if (i < j) sets.union_set(i, j);
    }
  }
  Components result;
  result.of_vertex.assign(n, Components::kNone);
  std::vector<std::uint32_t> number(n, Components::kNone);
  for (std::size_t i = 0; i < n; ++i) {
    if (is_anchor(graph.patch(i))) continue;
    std::uint32_t& of_set = number[sets.find_set(i)];
    if (of_set == Components::kNone) of_set = static_cast<std::uint32_t>(result.count++);
    result.of_vertex[i] = of_set;
  }
  return result;
}

namespace {

/// Walks from `start` over its neighbour `next` to the next vertex that ends a curve, or back to `start`.
Curve walk_curve(const AttributeGraph& graph, std::uint32_t start, std::uint32_t next) {
  Curve curve{start, next};
  while (curve.back() != start && graph.degree(curve.back()) == 2) {
    const auto sides = graph.neighbours(curve.back());
    curve.push_back(sides[0] == curve[curve.size() - 2] ? sides[1] : sides[0]);
  }
  return curve;
}

/// Returns whether a curve has its listed direction: lower end first; a ring by its lower neighbour.
bool is_listed_way(const Curve& curve) {
  if (curve.front() != curve.back()) return curve.front() < curve.back();
  return curve.size() < 2 || curve[1] < curve[curve.size() - 2];
}

}  // namespace

std::vector<Curve> curves(const AttributeGraph& graph) {
  std::vector<Curve> result;
  std::vector<bool> seen(graph.size(), false);
  const auto take = [&](Curve curve) {
    for (const std::uint32_t v : curve) seen[v] = true;
    if (is_listed_way(curve)) result.push_back(std::move(curve));
  };
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    if (is_anchor(graph.patch(v)))
      seen[v] = true;
    else if (graph.degree(v) == 0)
      take({v});
    if (graph.degree(v) == 2) continue;
    for (const std::uint32_t next : graph.neighbours(v)) take(walk_curve(graph, v, next));
  }
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    if (!seen[v]) take(walk_curve(graph, v, graph.neighbours(v)[0]));
  }
  std::vector<std::pair<std::uint32_t, std::size_t>> order_of(result.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    order_of[i] = {*std::min_element(result[i].begin(), result[i].end()), i};
  }
  std::sort(order_of.begin(), order_of.end(), [&](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : result[a.second] < result[b.second];
  });
  std::vector<Curve> sorted;
  sorted.reserve(result.size());
  for (const auto& [lowest, i] : order_of) sorted.push_back(std::move(result[i]));
  return sorted;
}

double seen_length(const AttributeGraph& graph) {
  double sum = 0;
  for (const Edge& edge : graph.edges()) {
    const Patch &a = graph.patch(graph.index_of(edge.a)), &b = graph.patch(graph.index_of(edge.b));
    if (is_seen(a, b)) sum += distance(a.position, b.position);
  }
  return sum;
}

}  // namespace emberfold::graph
