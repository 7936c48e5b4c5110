// SPDX-License-Identifier: Apache-2.0
// Quilting: a still of 384² grown to 1024² with blocks of 64, and a time-lapse of 512² and 1000 frames in
// colour grown to 1024² (search and seams, without reading and rendering). On as many threads as there are.
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/rng.hpp"
#include "dytex/quilting/quilt.hpp"
#include "dytex/quilting/quilt_measures.hpp"
#include "dytex/quilting/render.hpp"

using namespace emberfold;

namespace {

cv::Mat blurred_noise(cv::Size size, double sigma, std::uint32_t stream) {
  cv::Mat noise(size, CV_32FC3);
  core::Rng rng(1, {stream, 0, 0});
  for (float& value : cv::Mat_<float>(noise.reshape(1))) value = static_cast<float>(rng.normal());
  cv::GaussianBlur(noise, noise, {}, sigma, sigma, cv::BORDER_REFLECT);
  return noise * (2 * sigma);
}

/// Spots that come up at their own time and pace, on a ground of noise, with grain of SD `grain`.
dytex::Trajectories make_lapse(int side, int frames, double grain) {
  const cv::Size size(side, side);
  dytex::Trajectories lapse({side, side, 3, CV_8U, 25, 255, frames});
  const cv::Mat ground = blurred_noise(size, 2, 1), spots = blurred_noise(size, 5, 2),
                when = blurred_noise(size, 4, 3);
  cv::Mat grains(size, CV_16SC3);
  for (int t = 0; t < frames; ++t) {
    const double time = frames > 1 ? 4.0 * t / (frames - 1) - 2 : 0;
    cv::Mat grown;
    cv::exp(2 * (when - cv::Scalar::all(time)), grown);
    grown = spots / (1 + grown);  // a sigmoid of time at every place
    cv::Mat frame;
    cv::Mat(128 + 30 * ground + 60 * grown).convertTo(frame, CV_8U);
    cv::theRNG().state = static_cast<std::uint64_t>(t) + 1;
    cv::randn(grains, 0, grain);
    cv::add(frame, grains, frame, cv::noArray(), CV_8U);
    lapse.add(frame);
  }
  lapse.finish();
  return lapse;
}

dytex::QuiltOptions options_for(int side) {
  dytex::QuiltOptions options;
  options.size = {side, side};
  return options;
}

void report(benchmark::State& state, const dytex::Trajectories& lapse, const dytex::QuiltResult& result) {
  const std::vector<const dytex::Trajectories*> sources{&lapse};
  const auto measures = dytex::measure_quilt(result.map, result.choices, sources);
  double compared = 0;
  for (const auto& choice : result.choices) compared += static_cast<double>(choice.compared);
  state.counters["compared"] = compared / static_cast<double>(result.choices.size());
  state.counters["seam_ratio"] = measures.seam_ratio();
  state.counters["verbatim"] = measures.verbatim_blocks;
}

void quilt_still(benchmark::State& state) {
  const auto lapse = make_lapse(384, 1, 0);
  const std::vector<dytex::QuiltSource> sources{{&lapse, {}, {}}};
  dytex::QuiltResult result;
  for (auto _ : state) result = dytex::quilt(sources, options_for(1024));
  report(state, lapse, result);
}
BENCHMARK(quilt_still)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

void quilt_lapse(benchmark::State& state, double grain) {
  const auto lapse = make_lapse(512, 1000, grain);
  const std::vector<dytex::QuiltSource> sources{{&lapse, {}, {}}};
  dytex::QuiltResult result;
  for (auto _ : state) result = dytex::quilt(sources, options_for(1024));
  report(state, lapse, result);
}
BENCHMARK_CAPTURE(quilt_lapse, clean, 0.0)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Iterations(1);
BENCHMARK_CAPTURE(quilt_lapse, grainy, 3.0)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Iterations(1);

/// A chunk of 16 frames of 1024², drawn from 512²: the time of all of them.
void render_chunk(benchmark::State& state, bool controlled) {
  const auto lapse = make_lapse(512, 64, 0);
  const std::vector<dytex::QuiltSource> sources{{&lapse, {}, {}}};
  auto options = options_for(1024);
  const auto map = dytex::quilt(sources, options).map;
  dytex::TimeControl control;
  if (controlled) {
    control.rate = cv::Mat(1024, 1024, CV_32F);
    for (int x = 0; x < 1024; ++x) control.rate.col(x).setTo(static_cast<float>(x) / 1023);
  }
  const std::vector<const dytex::Trajectories*> held{&lapse};
  for (auto _ : state) benchmark::DoNotOptimize(dytex::render_quilt(map, held, control, 16, 16));
}
BENCHMARK_CAPTURE(render_chunk, plain, false)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(render_chunk, controlled, true)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime();

}  // namespace
