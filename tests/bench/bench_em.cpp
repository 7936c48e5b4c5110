// SPDX-License-Identifier: Apache-2.0
// An iteration of EM, τ = 100, n = 50: by the Gram matrix it must not depend on the number of values, 70 400
// or 704 000; value by value (noise per value, a third of the pixels hidden) it goes with it. CPU time of the
// iterations alone, without the passes before and after.
#include <cmath>
#include <ctime>
#include <optional>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>

#include "core/rng.hpp"
#include "dytex/estimation/em.hpp"

using namespace emberfold;

namespace {

constexpr int kFrames = 100, kComponents = 50;

core::Clip make_clip(int width, int height) {
  core::Clip clip{{width, height, 1, CV_8U, 25, 255, kFrames}, {}};
  core::Rng rng(1);
  for (int t = 0; t < kFrames; ++t) {
    cv::Mat frame(height, width, CV_8U);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const double wave = 40 * std::sin(0.05 * x + 0.3 * t) + 30 * std::sin(0.07 * y - 0.2 * t + 0.01 * x);
        frame.at<unsigned char>(y, x) = cv::saturate_cast<unsigned char>(128 + wave + rng.uniform(-8, 8));
      }
    clip.frames.push_back(frame);
  }
  return clip;
}

dytex::Missing hidden_third(const core::ClipInfo& info) {
  core::Clip mask{{info.width, info.height, 1, CV_8U, 25, 255, kFrames}, {}};
  core::Rng rng(2);
  for (int t = 0; t < kFrames; ++t) {
    mask.frames.emplace_back(info.height, info.width, CV_8U, cv::Scalar(0));
    for (unsigned char& value : cv::Mat_<unsigned char>(mask.frames.back()))
      value = rng.uniform() < 1.0 / 3 ? 255 : 0;
  }
  core::ClipSource source(mask);
  return {source, info};
}

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

void em_iteration(benchmark::State& state, int width, int height, bool per_value, bool hidden) {
  const core::Clip clip = make_clip(width, height);
  core::ClipSource source(clip);
  const auto start = dytex::learn(source, {.components = kComponents, .energy = {}}).texture;
  const dytex::Missing missing = hidden ? hidden_third(clip.info) : dytex::Missing();
  dytex::EmOptions options;
  options.iterations = per_value || hidden ? 2 : 10;
  options.tolerance = 0;
  options.noise_per_value = per_value;
  for (auto _ : state) {
    // From the second report of an iteration to the last one: filter, smoother, both M-steps.
    std::optional<double> first;
    double last = 0;
    int reports = 0;
    const core::Context context({}, [&](std::string_view stage, double) {
      if (stage != "maximising likelihood") return;
      last = cpu_seconds();
      if (!first) first = last;
      ++reports;
    });
    benchmark::DoNotOptimize(dytex::maximise_likelihood(source, start, options, missing, context));
    state.SetIterationTime((last - *first) / (reports - 1));
  }
}
BENCHMARK_CAPTURE(em_iteration, gram_70k, 320, 220, false, false)
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime();
BENCHMARK_CAPTURE(em_iteration, gram_704k, 1024, 688, false, false)
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime();
BENCHMARK_CAPTURE(em_iteration, per_value_70k, 320, 220, true, false)
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime();
BENCHMARK_CAPTURE(em_iteration, hidden_third_70k, 320, 220, false, true)
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime()
    ->Iterations(1);

}  // namespace
