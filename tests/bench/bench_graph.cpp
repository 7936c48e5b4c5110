// SPDX-License-Identifier: Apache-2.0
// Graph algorithms of the library beside Boost's on the same graphs.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <benchmark/benchmark.h>
#include <boost/graph/connected_components.hpp>
#include <boost/graph/dijkstra_shortest_paths.hpp>

#include "graph/boost_graph.hpp"
#include "graph/events/joints.hpp"
#include "tests/bench/swaying.hpp"

using namespace emberfold;

namespace {

graph::AttributeGraph frame(const benchmark::State& state) {
  return bench::swaying(static_cast<std::size_t>(state.range(0)), 0);
}

void components(benchmark::State& state) {
  const auto graph = frame(state);
  for (auto _ : state) benchmark::DoNotOptimize(graph::components(graph).count);
}

void components_boost(benchmark::State& state) {
  const auto graph = frame(state);
  for (auto _ : state) {
    std::vector<std::uint32_t> part(graph.size());
    const auto map = boost::make_iterator_property_map(part.begin(), get(boost::vertex_index, graph));
    benchmark::DoNotOptimize(boost::connected_components(graph, map));
  }
}

void shortest_paths(benchmark::State& state) {
  const auto graph = frame(state);
  graph::detail::ShortestPaths paths(graph);
  const std::uint32_t first = 0;
  for (auto _ : state) {
    paths.search(std::span(&first, 1));
    benchmark::DoNotOptimize(paths.reached().size());
  }
}

void shortest_paths_boost(benchmark::State& state) {
  const auto graph = frame(state);
  std::vector<double> length(graph.size());
  for (auto _ : state) {
    boost::dijkstra_shortest_paths(graph, 0,
                                   boost::weight_map(graph::edge_lengths(graph)).distance_map(length.data()));
    benchmark::DoNotOptimize(length.data());
  }
}

BENCHMARK(components)->Arg(200)->Arg(2000)->Unit(benchmark::kMicrosecond);
BENCHMARK(components_boost)->Arg(200)->Arg(2000)->Unit(benchmark::kMicrosecond);
BENCHMARK(shortest_paths)->Arg(200)->Arg(2000)->Unit(benchmark::kMicrosecond);
BENCHMARK(shortest_paths_boost)->Arg(200)->Arg(2000)->Unit(benchmark::kMicrosecond);

}  // namespace
