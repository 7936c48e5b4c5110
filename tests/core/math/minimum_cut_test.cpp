// SPDX-License-Identifier: Apache-2.0
#include "core/math/minimum_cut.hpp"

#include <limits>
#include <tuple>
#include <vector>

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/push_relabel_max_flow.hpp>

#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using core::MinimumCut;

namespace {

struct Problem {
  int nodes = 0;
  std::vector<std::pair<int, int>> costs;             // on the first side, on the second
  std::vector<std::tuple<int, int, int, int>> edges;  // a, b, cost, reverse cost
};

Problem random_problem(int nodes, int edges, std::uint64_t seed, std::uint32_t levels) {
  core::Rng rng(seed);
  const auto below = [&](std::uint32_t n) { return static_cast<int>(rng.below(n)); };
  Problem problem{nodes, {}, {}};
  for (int i = 0; i < nodes; ++i) {
    const int first = below(levels), second = below(levels);
    problem.costs.emplace_back(below(3) == 0 ? 0 : first, below(3) == 0 ? 0 : second);
  }
  for (int e = 0; e < edges; ++e) {
    const int a = below(static_cast<std::uint32_t>(nodes)),
              step = 1 + below(static_cast<std::uint32_t>(nodes - 1));
    const int cost = below(levels), reverse = below(levels);
    problem.edges.emplace_back(a, (a + step) % nodes, cost, reverse);
  }
  return problem;
}

// A cube whose neighbours are joined, as in the cuts of seams.
Problem random_cube(int side, std::uint64_t seed) {
  core::Rng rng(seed);
  Problem problem{side * side * side, {}, {}};
  for (int i = 0; i < problem.nodes; ++i) {
    const int x = i % side;
    problem.costs.emplace_back(x + 1 == side ? 5000 : 0, x == 0 ? 5000 : 0);
    for (const int step : {1, side, side * side}) {
      if (i / step % side + 1 == side) continue;
      const auto cost = static_cast<int>(rng.below(200)), reverse = static_cast<int>(rng.below(200));
      problem.edges.emplace_back(i, i + step, cost, reverse);
    }
  }
  return problem;
}

template <class IsSecond>
std::int64_t cost_of(const Problem& problem, const IsSecond& is_second) {
  std::int64_t sum = 0;
  for (int i = 0; i < problem.nodes; ++i) {
    const auto& [first, second] = problem.costs[static_cast<std::size_t>(i)];
    sum += is_second(i) ? second : first;
  }
  for (const auto& [a, b, cost, reverse] : problem.edges)
    if (is_second(a) != is_second(b)) sum += is_second(b) ? cost : reverse;
  return sum;
}

struct Solved {
  std::int64_t cost = 0;
  std::vector<bool> second;
};

Solved solved(const Problem& problem) {
  const auto nodes = static_cast<std::size_t>(problem.nodes);
  MinimumCut cut(nodes);
  for (std::size_t i = 0; i < nodes; ++i) {
    const auto& [first, second] = problem.costs[i];
    const int part_of_first = first / 3, part_of_second = second - second / 3;
    cut.add_costs(i, part_of_first, part_of_second);
    cut.add_costs(i, first - part_of_first, second - part_of_second);
  }
  for (const auto& [a, b, cost, reverse] : problem.edges)
    cut.add_edge(static_cast<std::size_t>(a), static_cast<std::size_t>(b), cost, reverse);
  Solved result{static_cast<std::int64_t>(cut.solve()), {}};
  for (std::size_t i = 0; i < nodes; ++i) result.second.push_back(cut.is_second(i));
  return result;
}

std::int64_t flow_by_push_relabel(const Problem& problem) {
  using Traits = boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::directedS>;
  using Graph = boost::adjacency_list<
      boost::vecS, boost::vecS, boost::directedS, boost::no_property,
      boost::property<boost::edge_capacity_t, long,
                      boost::property<boost::edge_residual_capacity_t, long,
                                      boost::property<boost::edge_reverse_t, Traits::edge_descriptor>>>>;
  Graph graph(static_cast<std::size_t>(problem.nodes) + 2);
  // Each way has a reverse edge of its own, which holds nothing: this method wants it so.
  const auto add = [&](std::size_t a, std::size_t b, long cost) {
    const auto there = boost::add_edge(a, b, graph).first, back = boost::add_edge(b, a, graph).first;
    boost::put(boost::edge_capacity, graph, there, cost);
    boost::put(boost::edge_capacity, graph, back, 0L);
    boost::put(boost::edge_reverse, graph, there, back);
    boost::put(boost::edge_reverse, graph, back, there);
  };
  const auto source = static_cast<std::size_t>(problem.nodes), sink = source + 1;
  for (std::size_t i = 0; i < source; ++i) {
    add(source, i, problem.costs[i].second);
    add(i, sink, problem.costs[i].first);
  }
  for (const auto& [a, b, cost, reverse] : problem.edges) {
    add(static_cast<std::size_t>(a), static_cast<std::size_t>(b), cost);
    add(static_cast<std::size_t>(b), static_cast<std::size_t>(a), reverse);
  }
  return boost::push_relabel_max_flow(graph, source, sink);
}

}  // namespace

TEST_CASE("a minimum cut costs the least of all partitions") {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const int nodes = 2 + static_cast<int>(seed % 9);
    const Problem problem =
        random_problem(nodes, static_cast<int>(seed % 25), seed, seed % 2 == 0 ? 3 : 1000);
    const Solved found = solved(problem);
    std::int64_t least = std::numeric_limits<std::int64_t>::max();
    for (unsigned sides = 0; sides < 1U << nodes; ++sides)
      least = std::min(least, cost_of(problem, [&](int i) { return (sides >> i & 1U) != 0; }));
    CHECK(found.cost == least);
    CHECK(cost_of(problem, [&](int i) -> bool { return found.second[static_cast<std::size_t>(i)]; }) ==
          least);
  }
}

TEST_CASE("a minimum cut of a volume costs what the push-relabel method finds") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Problem problem = seed % 2 == 0 ? random_cube(12, seed) : random_problem(1500, 9000, seed, 500);
    const Solved found = solved(problem);
    CHECK(found.cost == flow_by_push_relabel(problem));
    CHECK(cost_of(problem, [&](int i) -> bool { return found.second[static_cast<std::size_t>(i)]; }) ==
          found.cost);
  }
}
