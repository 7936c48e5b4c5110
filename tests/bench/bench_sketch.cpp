// SPDX-License-Identifier: Apache-2.0
// The sketch of one frame, on one thread: frames of the built-in fire clip, and strokes in noise.
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#ifdef EMBERFOLD_BENCH_APPS
#include "apps/builtin/builtin_clip.hpp"
#endif
#include "core/clip.hpp"
#include "core/parallel.hpp"
#include "core/rng.hpp"
#include "sketch/extract.hpp"

using namespace emberfold;

namespace {

cv::Size size_of(const benchmark::State& state) {
  return {static_cast<int>(state.range(0)), static_cast<int>(state.range(1))};
}

/// One frame after the other, over and over.
void extract_each(benchmark::State& state, const std::vector<cv::Mat>& frames) {
  const core::ThreadLimit one(1);
  std::size_t at = 0, vertices = 0;
  for (auto _ : state) {
    const graph::AttributeGraph graph = sketch::extract(frames[at % frames.size()], {});
    vertices += graph.size();
    ++at;
  }
  state.counters["vertices"] = static_cast<double>(vertices) / static_cast<double>(at);
}

#ifdef EMBERFOLD_BENCH_APPS
void sketch_fire(benchmark::State& state) {
  apps::BuiltinOptions options;
  options.width = size_of(state).width;
  options.height = size_of(state).height;
  options.frames = 24;
  const core::Clip clip = apps::make_builtin(options).clip;
  std::vector<cv::Mat> frames;
  for (std::size_t i = 4; i < clip.frames.size(); i += 5)
    frames.push_back(core::to_levels(clip.frames[i], clip.info));
  extract_each(state, frames);
}
#endif

/// Bent bars of 2 to 5 px, one for each 4000 pixels, blurred by 1 px, in white noise of SD 10; grey.
cv::Mat strokes_in_noise(cv::Size size, std::uint64_t seed) {
  core::Rng rng(seed);
  cv::Mat frame(size, CV_32F, cv::Scalar(80));
  for (int i = 0; i < size.area() / 4000; ++i) {
    double x = rng.uniform(0, size.width), y = rng.uniform(0, size.height), a = rng.uniform(0, 6.283);
    const double bend = rng.uniform(-0.1, 0.1);
    std::vector<cv::Point> points;
    for (int k = 0; k < 20; ++k, x += 4 * std::cos(a), y += 4 * std::sin(a), a += bend)
      points.emplace_back(cvRound(x), cvRound(y));
    cv::polylines(frame, points, false, cv::Scalar(rng.uniform(120, 220)),
                  2 + static_cast<int>(rng.below(4)));
  }
  cv::GaussianBlur(frame, frame, {}, 1);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) frame.at<float>(y, x) += static_cast<float>(10 * rng.normal());
  return frame;
}

void sketch_noisy(benchmark::State& state) {
  std::vector<cv::Mat> frames;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) frames.push_back(strokes_in_noise(size_of(state), seed));
  extract_each(state, frames);
}

void both_sizes(benchmark::internal::Benchmark* b) {
  b->Args({320, 240})->Args({1280, 720})->Unit(benchmark::kMillisecond);
}

#ifdef EMBERFOLD_BENCH_APPS
BENCHMARK(sketch_fire)->Apply(both_sizes);
#endif
BENCHMARK(sketch_noisy)->Apply(both_sizes);

}  // namespace
