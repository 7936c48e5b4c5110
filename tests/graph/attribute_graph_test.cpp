// SPDX-License-Identifier: Apache-2.0
#include "graph/attribute_graph.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <memory_resource>
#include <set>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using graph::AttributeGraph;
using graph::Edge;

namespace {
std::vector<graph::Vertex> row(std::uint32_t count) {
  std::vector<graph::Vertex> vertices;
  for (std::uint32_t i = 0; i < count; ++i) vertices.push_back(test::vertex(i, 5 * i, 0));
  return vertices;
}
std::string refusal(std::vector<graph::Vertex> vertices, std::vector<Edge> edges) {
  return test::message_of<core::InputError>([&] { AttributeGraph(std::move(vertices), std::move(edges)); });
}
}  // namespace

TEST_CASE("A graph is the same whatever order its parts come in", "[graph]") {
  core::Rng rng(1);
  for (int k = 0; k < 20; ++k) {
    const AttributeGraph graph = test::random_graph(rng, 5, 4);
    std::vector<graph::Vertex> vertices(graph.vertices().rbegin(), graph.vertices().rend());
    std::vector<Edge> edges(graph.edges().rbegin(), graph.edges().rend());
    for (Edge& edge : edges) std::swap(edge.a, edge.b);
    CHECK(AttributeGraph(vertices, edges) == graph);
  }
}

TEST_CASE("Neighbours are exactly the other ends of a vertex's edges, ascending", "[graph]") {
  core::Rng rng(2);
  for (int k = 0; k < 20; ++k) {
    const AttributeGraph graph = test::random_graph(rng, 5, 6);
    std::vector<std::set<std::uint32_t>> expected(graph.size());
    for (const Edge& edge : graph.edges()) {
      const auto i = graph.index_of(edge.a), j = graph.index_of(edge.b);
      expected[i].insert(static_cast<std::uint32_t>(j));
      expected[j].insert(static_cast<std::uint32_t>(i));
    }
    for (std::size_t i = 0; i < graph.size(); ++i) {
      const auto found = graph.neighbours(i);
      CHECK(std::vector<std::uint32_t>(found.begin(), found.end()) ==
            std::vector<std::uint32_t>(expected[i].begin(), expected[i].end()));
    }
  }
}

TEST_CASE("Vertices are found by their ids, with gaps too", "[graph]") {
  std::vector<graph::Vertex> vertices{test::vertex(900, 0, 0), test::vertex(7, 1, 0), test::vertex(9, 2, 0)};
  const AttributeGraph graph(vertices, {});
  CHECK(graph.index_of({7}) == 0);
  CHECK(graph.index_of({9}) == 1);
  CHECK(graph.index_of({900}) == 2);
  for (const std::uint32_t id : {0U, 6U, 8U, 10U, 899U, 901U}) CHECK(graph.index_of({id}) == graph.size());
  CHECK(AttributeGraph().index_of({0}) == 0);
}

TEST_CASE("What is no graph is refused with the ids", "[graph]") {
  auto twice = row(3);
  twice[2].id = {1};
  CHECK(test::contains(refusal(twice, {}), "vertex 1 is there twice"));
  CHECK(test::contains(refusal(row(3), {{{0}, {4}}}), "vertex 4, which is not there"));
  CHECK(test::contains(refusal(row(3), {{{5}, {1}}}), "vertex 5, which is not there"));
  CHECK(test::contains(refusal(row(3), {{{2}, {2}}}), "vertex 2 has an edge to itself"));
  CHECK(test::contains(refusal(row(3), {{{0}, {1}}, {{1}, {0}}}), "vertex 0 to vertex 1 is there twice"));
  auto infinite = row(2);
  infinite[1].patch.left[2] = std::numeric_limits<float>::infinity();
  CHECK(test::contains(refusal(infinite, {}), "vertex 1 holds a number that is not finite"));
  infinite = row(2);
  infinite[0].patch.position.y = std::nan("");
  CHECK(test::contains(refusal(infinite, {}), "vertex 0"));
}

TEST_CASE("Stroke identities replace each other and nothing else", "[graph]") {
  core::Rng rng(3);
  const AttributeGraph graph = test::random_graph(rng, 4, 2);
  std::vector<graph::SubgraphId> ids(graph.size());
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = {static_cast<std::uint32_t>(100 + i)};
  const AttributeGraph named = graph.with_subgraphs(ids);
  for (std::size_t i = 0; i < ids.size(); ++i) CHECK(named.vertices()[i].subgraph == ids[i]);
  CHECK(named.with_subgraphs(std::vector<graph::SubgraphId>(graph.size())) == graph);
  ids.pop_back();
  CHECK_THROWS_AS(graph.with_subgraphs(ids), core::InputError);
}

TEST_CASE("Components are what a walk along edges can reach, numbered by lowest vertex", "[graph]") {
  core::Rng rng(4);
  for (int k = 0; k < 30; ++k) {
    const AttributeGraph graph = test::random_graph(rng, 7, 3);
    std::vector<int> expected(graph.size(), -1);
    int count = 0;
    for (std::size_t start = 0; start < graph.size(); ++start) {
      if (expected[start] >= 0) continue;
      std::vector<std::size_t> todo{start};
      expected[start] = count;
      while (!todo.empty()) {
        const std::size_t v = todo.back();
        todo.pop_back();
        for (const std::uint32_t w : graph.neighbours(v)) {
          if (expected[w] < 0) todo.push_back(w), expected[w] = count;
        }
      }
      ++count;
    }
    const graph::Components parts = graph::components(graph);
    CHECK(parts.count == static_cast<std::size_t>(count));
    CHECK(std::vector<int>(parts.of_vertex.begin(), parts.of_vertex.end()) == expected);
  }
}

TEST_CASE("Curves take every edge once and break at branchings only", "[graph]") {
  core::Rng rng(5);
  for (int k = 0; k < 40; ++k) {
    const AttributeGraph graph = test::random_graph(rng, 6, rng.below(9));
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
    std::set<std::uint32_t> seen;
    for (const graph::Curve& curve : graph::curves(graph)) {
      REQUIRE_FALSE(curve.empty());
      seen.insert(curve.begin(), curve.end());
      if (curve.size() == 1) CHECK(graph.degree(curve[0]) == 0);
      for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
        ++uses[std::minmax(curve[i], curve[i + 1])];
        if (i > 0) CHECK(graph.degree(curve[i]) == 2);
      }
      if (curve.front() != curve.back() || graph.degree(curve.front()) != 2) {
        if (curve.size() > 1) {
          CHECK(graph.degree(curve.front()) != 2);
          CHECK(graph.degree(curve.back()) != 2);
        }
      }
    }
    CHECK(seen.size() == graph.size());
    CHECK(uses.size() == graph.edges().size());
    for (const auto& [edge, count] : uses) CHECK(count == 1);
  }
}

TEST_CASE("A path, a ring, a T and a loop on a stem come out as their curves", "[graph]") {
  using Curves = std::vector<graph::Curve>;
  const auto curves_of = [](std::uint32_t n, std::vector<Edge> edges) {
    return graph::curves(AttributeGraph(row(n), std::move(edges)));
  };
  CHECK(curves_of(3, {{{2}, {0}}, {{0}, {1}}}) == Curves{{1, 0, 2}});
  CHECK(curves_of(4, {{{0}, {1}}, {{1}, {2}}, {{2}, {3}}, {{3}, {0}}}) == Curves{{0, 1, 2, 3, 0}});
  CHECK(curves_of(4, {{{0}, {1}}, {{1}, {2}}, {{1}, {3}}}) == Curves{{0, 1}, {1, 2}, {1, 3}});
  CHECK(curves_of(4, {{{0}, {1}}, {{1}, {2}}, {{2}, {3}}, {{3}, {1}}}) == Curves{{0, 1}, {1, 2, 3, 1}});
  CHECK(curves_of(2, {}) == Curves{{0}, {1}});
  CHECK(curves_of(0, {}).empty());
}

TEST_CASE("Anchors are vertices, but no curves or components, and have no edges", "[graph][anchors]") {
  core::Rng rng(5);
  for (int k = 0; k < 20; ++k) {
    const AttributeGraph strokes = test::random_graph(rng, 5, 4);
    const AttributeGraph both = test::with_anchors(strokes, rng, 30);
    REQUIRE(both.size() == strokes.size() + 30);
    CHECK(graph::without_anchors(both) == strokes);
    CHECK(graph::curves(both) == graph::curves(strokes));
    const auto parts = graph::components(both), expected = graph::components(strokes);
    CHECK(parts.count == expected.count);
    for (std::size_t i = 0; i < both.size(); ++i)
      CHECK(parts.of_vertex[i] == (i < strokes.size() ? expected.of_vertex[i] : graph::Components::kNone));
  }
  // Ids stay, whatever order they come in.
  const AttributeGraph mixed({test::vertex(9, 5, 0), test::anchor(4, 2, 3), test::vertex(2, 0, 0)},
                             {{{2}, {9}}});
  CHECK(graph::without_anchors(mixed) ==
        AttributeGraph({test::vertex(2, 0, 0), test::vertex(9, 5, 0)}, {{{2}, {9}}}));
  CHECK(test::contains(refusal({test::vertex(0, 0, 0), test::anchor(1, 2, 3)}, {{{0}, {1}}}),
                       "ends at vertex 1, an anchor"));
}

namespace {

/// Counts what is taken from the heap and given back.
class CountingMemory final : public std::pmr::memory_resource {
 public:
  int blocks = 0;
  std::size_t bytes = 0;

 private:
  void* do_allocate(std::size_t size, std::size_t alignment) override {
    ++blocks, bytes += size;
    return std::pmr::new_delete_resource()->allocate(size, alignment);
  }
  void do_deallocate(void* block, std::size_t size, std::size_t alignment) override {
    --blocks, bytes -= size;
    std::pmr::new_delete_resource()->deallocate(block, size, alignment);
  }
  [[nodiscard]] bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
    return this == &other;
  }
};

}  // namespace

TEST_CASE("Copies of a graph share its memory, and what is made of it lies there", "[graph]") {
  const auto memory = std::make_shared<CountingMemory>();
  core::Rng rng(2);
  const AttributeGraph plain = test::random_graph(rng, 5, 4);
  {
    const AttributeGraph kept = plain.kept_in(memory);
    CHECK(kept == plain);
    CHECK(kept.memory() == memory);
    CHECK(memory->blocks == 1);
    CHECK(kept.vertices().data() != plain.vertices().data());
    for (std::size_t i = 0; i < plain.size(); ++i)
      CHECK(std::ranges::equal(kept.neighbours(i), plain.neighbours(i)));
    AttributeGraph copy = kept;
    CHECK(copy.kept_in(memory).vertices().data() == kept.vertices().data());
    const AttributeGraph moved = std::move(copy);
    CHECK(moved.vertices().data() == kept.vertices().data());
    CHECK(memory->blocks == 1);
    const auto curves = kept.with_curves(std::vector<graph::CurveId>(kept.size(), {7}));
    CHECK(memory->blocks == 2);
    CHECK(curves.vertices().front().curve == graph::CurveId{7});
    CHECK(kept.vertices().front().curve == graph::CurveId{});
    CHECK(memory->bytes < 2 * (kept.size() * (sizeof(graph::Vertex) + 4) + kept.edges().size() * 16 + 8));
  }
  CHECK(memory->blocks == 0);
  CHECK(AttributeGraph().kept_in(memory) == AttributeGraph());
  CHECK(memory->blocks == 0);
}
