// SPDX-License-Identifier: Apache-2.0
// Matching one frame's graph to the next one's: strokes that sway.
#include <cstddef>

#include <benchmark/benchmark.h>

#include "graph/matching/match.hpp"
#include "tests/bench/swaying.hpp"

using namespace emberfold;

namespace {

void match_pair(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  const graph::AttributeGraph before = bench::swaying(count, 0), after = bench::swaying(count, 1);
  std::size_t links = 0;
  for (auto _ : state) links = graph::match_frames(before, after, {}, {}).size();
  state.counters["linked"] = static_cast<double>(links) / static_cast<double>(before.size());
}

BENCHMARK(match_pair)->Arg(200)->Arg(2000)->Unit(benchmark::kMillisecond);

}  // namespace
