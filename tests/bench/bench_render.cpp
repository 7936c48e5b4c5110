// SPDX-License-Identifier: Apache-2.0
// Drawing the patches of one frame, and drawing and filling it.
#include <cmath>
#include <cstdint>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/rng.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/rendering/render.hpp"

using namespace emberfold;

namespace {

/// `count` patches on bent strokes of twelve, 5 px apart.
graph::AttributeGraph strokes(cv::Size size, int count) {
  core::Rng rng(1);
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (int i = 0; i < count; i += 12) {
    graph::Point at{rng.uniform(0, size.width), rng.uniform(0, size.height)};
    double theta = rng.uniform(-3.1, 3.1);
    const double bend = rng.uniform(-0.15, 0.15);
    for (int k = 0; k < 12 && i + k < count; ++k, theta += bend) {
      graph::Patch patch;
      patch.position = at;
      patch.theta = theta;
      patch.width = 2.5;
      patch.blur = 1.2;
      patch.middle = {200, 190, 180};
      const auto id = static_cast<std::uint32_t>(i + k);
      vertices.push_back({{id}, {}, patch});
      if (k > 0) edges.push_back({{id - 1}, {id}});
      at = at + graph::Point{std::cos(theta), std::sin(theta)} * 5;
    }
  }
  return {vertices, edges};
}

cv::Size size_of(const benchmark::State& state) {
  return {static_cast<int>(state.range(0)), static_cast<int>(state.range(1))};
}

void render_fitted(benchmark::State& state) {
  const auto graph = strokes(size_of(state), static_cast<int>(state.range(2)));
  sketch::Sketchable drawn;
  for (auto _ : state) {
    drawn = sketch::draw_fitted(graph, size_of(state), static_cast<int>(state.range(3)));
    benchmark::DoNotOptimize(drawn.levels.data);
  }
  state.counters["share"] = drawn.share();
}

void render_and_fill(benchmark::State& state) {
  const auto graph = strokes(size_of(state), static_cast<int>(state.range(2)));
  for (auto _ : state) {
    const auto drawn = sketch::draw_fitted(graph, size_of(state), static_cast<int>(state.range(3)));
    benchmark::DoNotOptimize(sketch::fill(drawn.levels, drawn.mask).levels.data);
  }
}

void frames(benchmark::internal::Benchmark* b) {
  b->ArgNames({"w", "h", "patches", "channels"})->Unit(benchmark::kMillisecond);
  for (const int channels : {1, 3}) b->Args({320, 240, 300, channels})->Args({1280, 720, 3600, channels});
}

BENCHMARK(render_fitted)->Apply(frames);
BENCHMARK(render_and_fill)->Apply(frames);

}  // namespace
