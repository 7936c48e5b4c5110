// SPDX-License-Identifier: Apache-2.0
#include "graph/boost_graph.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>
#include <span>

#include <boost/concept/assert.hpp>
#include <boost/graph/biconnected_components.hpp>
#include <boost/graph/breadth_first_search.hpp>
#include <boost/graph/connected_components.hpp>
#include <boost/graph/dag_shortest_paths.hpp>
#include <boost/graph/dijkstra_shortest_paths_no_color_map.hpp>
#include <boost/graph/graph_concepts.hpp>
#include <boost/graph/kruskal_min_spanning_tree.hpp>
#include <boost/graph/topological_sort.hpp>

#include "core/error.hpp"
#include "graph/boost_links.hpp"
#include "graph/events/joints.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;
using Catch::Matchers::WithinAbs;
using graph::AttributeGraph;
using graph::LinkGraph;
using graph::PatchEdge;

BOOST_CONCEPT_ASSERT((boost::VertexListGraphConcept<AttributeGraph>));
BOOST_CONCEPT_ASSERT((boost::EdgeListGraphConcept<AttributeGraph>));
BOOST_CONCEPT_ASSERT((boost::AdjacencyGraphConcept<AttributeGraph>));
BOOST_CONCEPT_ASSERT((boost::BidirectionalGraphConcept<AttributeGraph>));
BOOST_CONCEPT_ASSERT(
    (boost::ReadablePropertyGraphConcept<AttributeGraph, std::uint32_t, boost::vertex_index_t>));
BOOST_CONCEPT_ASSERT((boost::VertexListGraphConcept<LinkGraph>));
BOOST_CONCEPT_ASSERT((boost::EdgeListGraphConcept<LinkGraph>));
BOOST_CONCEPT_ASSERT((boost::AdjacencyGraphConcept<LinkGraph>));
BOOST_CONCEPT_ASSERT((boost::BidirectionalGraphConcept<LinkGraph>));
BOOST_CONCEPT_ASSERT((boost::ReadablePropertyGraphConcept<LinkGraph, std::uint32_t, boost::vertex_index_t>));

namespace {

/// Shortest distances between all pairs, by relaxing over every vertex (Floyd & Warshall).
std::vector<std::vector<double>> all_distances(const AttributeGraph& graph) {
  const std::size_t n = graph.size();
  std::vector distance(n, std::vector(n, std::numeric_limits<double>::max()));
  for (std::size_t i = 0; i < n; ++i) {
    distance[i][i] = 0;
    for (const std::uint32_t j : graph.neighbours(i))
      distance[i][j] = graph::distance(graph.patch(i).position, graph.patch(j).position);
  }
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        distance[i][j] = std::min(distance[i][j], distance[i][k] + distance[k][j]);
  return distance;
}

/// The vertices that links lead to from one, over any number of frames.
std::set<std::uint32_t> descendants(const LinkGraph& graph, std::uint32_t from) {
  std::set<std::uint32_t> found{from};
  for (std::uint32_t v = from; v < graph.size(); ++v)
    if (found.contains(v))
      for (const std::uint32_t next : graph.after(v)) found.insert(next);
  return found;
}

}  // namespace

TEST_CASE("Boost's walks over a graph meet each vertex and each edge once", "[graph][boost]") {
  core::Rng rng(3);
  for (int k = 0; k < 10; ++k) {
    const AttributeGraph graph = test::with_anchors(test::random_graph(rng, 5, 6), rng, 3);
    const auto [first, last] = vertices(graph);
    CHECK(std::distance(first, last) == static_cast<std::ptrdiff_t>(graph.size()));
    std::multiset<std::pair<std::uint32_t, std::uint32_t>> listed, walked, entered;
    const auto note = [&](auto& set, const PatchEdge& e) {
      set.emplace(std::min(source(e, graph), target(e, graph)), std::max(source(e, graph), target(e, graph)));
    };
    for (const PatchEdge& e : boost::make_iterator_range(edges(graph))) note(listed, e);
    for (const std::uint32_t v : boost::make_iterator_range(vertices(graph))) {
      for (const PatchEdge& e : boost::make_iterator_range(out_edges(v, graph))) {
        CHECK(source(e, graph) == v);
        if (source(e, graph) < target(e, graph)) note(walked, e);
      }
      for (const PatchEdge& e : boost::make_iterator_range(in_edges(v, graph))) {
        CHECK(target(e, graph) == v);
        if (source(e, graph) < target(e, graph)) note(entered, e);
      }
    }
    CHECK(listed.size() == num_edges(graph));
    CHECK(listed == walked);
    CHECK(listed == entered);
  }
  CHECK(PatchEdge{1, 2} == PatchEdge{2, 1});
  CHECK_FALSE(PatchEdge{1, 2} == PatchEdge{1, 3});
}

TEST_CASE("Boost's algorithms on a graph agree with independent computations", "[graph][boost]") {
  core::Rng rng(4);
  for (int k = 0; k < 10; ++k) {
    const AttributeGraph graph = test::random_graph(rng, 6, 5);
    const auto expected = all_distances(graph);

    std::vector<std::uint32_t> part(graph.size());
    const auto parts = boost::connected_components(
        graph, boost::make_iterator_property_map(part.begin(), get(boost::vertex_index, graph)));
    CHECK(parts == graph::components(graph).count);
    CHECK(part == graph::components(graph).of_vertex);

    std::vector<double> length(graph.size());
    boost::dijkstra_shortest_paths_no_color_map(
        graph, 0, boost::weight_map(graph::edge_lengths(graph)).distance_map(length.data()));
    for (std::size_t v = 0; v < graph.size(); ++v) {
      if (part[v] == part[0])
        CHECK_THAT(length[v], WithinAbs(expected[0][v], 1e-9));
      else
        CHECK(length[v] == std::numeric_limits<double>::max());
    }

    std::vector<PatchEdge> tree;
    boost::kruskal_minimum_spanning_tree(graph, std::back_inserter(tree),
                                         boost::weight_map(graph::edge_lengths(graph)));
    CHECK(tree.size() == graph.size() - parts);
    // A shortest tree holds between its edges' ends no way that avoids longer edges (cycle property).
    for (const PatchEdge& e : boost::make_iterator_range(edges(graph))) {
      if (std::ranges::find(tree, e) != tree.end()) continue;
      std::vector<graph::Edge> shorter;
      const double own = get(graph::edge_lengths(graph), e);
      for (const PatchEdge& t : tree) {
        const auto a = graph.vertices()[t.source].id, b = graph.vertices()[t.target].id;
        if (get(graph::edge_lengths(graph), t) <= own) shorter.push_back({std::min(a, b), std::max(a, b)});
      }
      const AttributeGraph forest({graph.vertices().begin(), graph.vertices().end()}, shorter);
      const auto of = graph::components(forest).of_vertex;
      CHECK(of[e.source] == of[e.target]);
    }
  }
}

TEST_CASE("Boost finds the cut vertices of a graph", "[graph][boost]") {
  core::Rng rng(5);
  for (int k = 0; k < 10; ++k) {
    const AttributeGraph graph = test::random_graph(rng, 4, 5);
    std::set<std::uint32_t> found, expected;
    boost::articulation_points(graph, std::inserter(found, found.end()));
    const std::size_t parts = graph::components(graph).count;
    for (std::uint32_t v = 0; v < graph.size(); ++v) {
      std::vector<graph::Vertex> others(graph.vertices().begin(), graph.vertices().end());
      others.erase(others.begin() + v);
      std::vector<graph::Edge> left;
      const auto id = graph.vertices()[v].id;
      std::ranges::copy_if(graph.edges(), std::back_inserter(left),
                           [&](const graph::Edge& e) { return e.a != id && e.b != id; });
      if (graph::components({others, left}).count > parts) expected.insert(v);
    }
    CHECK(found == expected);
  }
}

TEST_CASE("Links are a directed graph without circles", "[graph][boost]") {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    const graph::MotionGraph motion = test::random_motion(seed, 6, 3);
    const LinkGraph links(motion);
    std::size_t patches = 0, expected = 0;
    for (const auto& frame : motion.sketch.frames) patches += frame.size();
    for (const auto& gap : motion.links) expected += gap.size();
    CHECK(num_vertices(links) == patches);
    REQUIRE(num_edges(links) == expected);

    std::size_t listed = 0;
    for (const auto& e : boost::make_iterator_range(edges(links))) {
      const std::size_t frame = links.frame_of(e.target);
      REQUIRE(links.frame_of(e.source) + 1 == frame);
      const graph::Link link{links.patch(e.source).id, links.patch(e.target).id};
      CHECK(std::ranges::binary_search(motion.links[frame], link));
      ++listed;
    }
    CHECK(listed == expected);
    for (const std::uint32_t v : boost::make_iterator_range(vertices(links)))
      for (const auto& e : boost::make_iterator_range(in_edges(v, links)))
        CHECK(std::ranges::count(links.after(source(e, links)), v) == 1);

    std::vector<std::uint32_t> order;
    boost::topological_sort(links, std::back_inserter(order));
    CHECK(order.size() == patches);

    std::vector<boost::default_color_type> colour(patches);
    const auto colours = boost::make_iterator_property_map(colour.begin(), get(boost::vertex_index, links));
    boost::breadth_first_search(links, 0, boost::color_map(colours));
    const auto reached = descendants(links, 0);
    for (std::uint32_t v = 0; v < patches; ++v)
      CHECK((colour[v] == boost::black_color) == reached.contains(v));
  }
}

TEST_CASE("Boost tells how long a patch can be followed", "[graph][boost]") {
  const graph::MotionGraph motion = test::random_motion(7, 8, 3);
  const LinkGraph links(motion);
  const auto one_frame =
      boost::make_function_property_map<LinkGraph::Edge, double>([](const LinkGraph::Edge&) { return -1.0; });
  std::vector<double> length(links.size());
  boost::dag_shortest_paths(links, 0, boost::weight_map(one_frame).distance_map(length.data()));
  double most = 0;
  for (const double l : length) most = std::min(most, l);
  std::size_t last = 0;
  for (const std::uint32_t v : descendants(links, 0)) last = std::max(last, links.frame_of(v));
  CHECK(-most == static_cast<double>(last));
}

TEST_CASE("Links that do not fit the frames make no graph", "[graph][boost]") {
  graph::MotionGraph motion = test::random_motion(1, 3, 3);
  motion.links.pop_back();
  CHECK_THROWS_AS(LinkGraph(motion), core::InputError);
}
