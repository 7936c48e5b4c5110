// SPDX-License-Identifier: Apache-2.0
// The motion model of swaying strokes: learning it, drawing from it, predicting by it.
#include <cstddef>

#include <benchmark/benchmark.h>

#include "graph/matching/match.hpp"
#include "mcmc/learning/fit.hpp"
#include "mcmc/simulation/predict.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "tests/bench/swaying.hpp"

using namespace emberfold;

namespace {

constexpr int kFrames = 60;

graph::MotionGraph swaying_clip(std::size_t patches) {
  graph::SketchSequence sketch;
  sketch.width = patches > 1000 ? 1280 : 320, sketch.height = patches > 1000 ? 720 : 240;
  for (int t = 0; t < kFrames; ++t) sketch.append(bench::swaying(patches, t));
  return graph::match(std::move(sketch), {});
}

void motion_fit(benchmark::State& state) {
  const auto motion = swaying_clip(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(mcmc::fit(motion));
}
BENCHMARK(motion_fit)->Arg(200)->Arg(2000)->Unit(benchmark::kMillisecond);

void motion_draw(benchmark::State& state) {
  const auto model = mcmc::fit(swaying_clip(static_cast<std::size_t>(state.range(0)))).model;
  mcmc::Synthesis synthesis(model, 1);
  double patches = 0;
  for (auto _ : state) patches += static_cast<double>(synthesis.next().size());
  state.counters["patches"] = patches / static_cast<double>(state.iterations());
}
BENCHMARK(motion_draw)->Arg(200)->Arg(2000)->Unit(benchmark::kMillisecond);

void motion_predict(benchmark::State& state) {
  const auto motion = swaying_clip(static_cast<std::size_t>(state.range(0)));
  const auto model = mcmc::fit(motion).model;
  for (auto _ : state) benchmark::DoNotOptimize(mcmc::predict(model, motion));
  state.SetItemsProcessed(state.iterations() * kFrames);
}
BENCHMARK(motion_predict)->Arg(200)->Arg(2000)->Unit(benchmark::kMillisecond);

}  // namespace
