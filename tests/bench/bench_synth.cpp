// SPDX-License-Identifier: Apache-2.0
// New frames of a model of swaying strokes, drawn in colour on two threads: graphs, strokes and what diffuses
// between them.
#include <cstddef>

#include <benchmark/benchmark.h>

#ifdef EMBERFOLD_BENCH_APPS

#include "core/parallel.hpp"
#include "graph/matching/match.hpp"
#include "mcmc/learning/fit.hpp"
#include "pipeline/frame_synthesis.hpp"
#include "tests/bench/swaying.hpp"

using namespace emberfold;

namespace {

constexpr int kFrames = 40;
const cv::Size kSize(320, 240);

mcmc::MotionModel learned_model(std::size_t patches) {
  graph::SketchSequence sketch;
  sketch.width = kSize.width, sketch.height = kSize.height;
  for (int t = 0; t < kFrames; ++t) sketch.append(bench::swaying(patches, t));
  return mcmc::fit(graph::match(std::move(sketch), {})).model;
}

void draw(benchmark::State& state, pipeline::FrameSynthesis frames) {
  const core::ThreadLimit limit(2);
  for (auto _ : state) benchmark::DoNotOptimize(frames.next(frames.batch()).data());
  state.SetItemsProcessed(state.iterations() * frames.batch());
  double patches = 0;
  for (const auto count : frames.statistics().patches) patches += static_cast<double>(count);
  state.counters["patches"] = patches / static_cast<double>(frames.statistics().patches.size());
}

sketch::RenderOptions colour_look(const mcmc::MotionModel& model) {
  auto look = pipeline::render_options(model, {});
  look.channels = 3;
  return look;
}

void synth_diffusion(benchmark::State& state) {
  const auto model = learned_model(static_cast<std::size_t>(state.range(0)));
  draw(state, {mcmc::Synthesis(model, 1), colour_look(model)});
}

BENCHMARK(synth_diffusion)->Arg(200)->Arg(800)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

#endif
