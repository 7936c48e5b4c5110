// SPDX-License-Identifier: Apache-2.0
// Learning linear dynamic textures of 50 components, and drawing frames from one; and what else could do it.
// On as many threads as there are, the peers as they come. peers_dytex.py sets numpy and scipy beside it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/SVD>
#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>

#include "core/parallel.hpp"
#include "core/rng.hpp"
#include "dytex/learn.hpp"
#include "dytex/synthesis/draw_frames.hpp"
#include "dytex/synthesize.hpp"

using namespace emberfold;

namespace {

constexpr int kComponents = 50;

/// Plane waves that travel, each at its own pace and strength, and grain.
core::Clip make_clip(int width, int height, int channels, int frames, int depth) {
  constexpr Eigen::Index kWaves = 40;
  const double white = depth == CV_8U ? 255 : 1;
  core::Clip clip{{width, height, channels, depth, 25, white, frames}, {}};
  const Eigen::Index m = Eigen::Index{width} * height * channels;
  core::Rng rng(1);
  Eigen::MatrixXf shapes(m, 2 * kWaves), courses(2 * kWaves, frames);
  for (Eigen::Index i = 0; i < kWaves; ++i) {
    const double across = rng.uniform(-0.3, 0.3), down = rng.uniform(-0.3, 0.3), pace = rng.uniform(0, 0.5),
                 strength = 30 / (1 + 0.2 * static_cast<double>(i));
    for (Eigen::Index p = 0; p < m; ++p) {
      const Eigen::Index pixel = p / channels, channel = p % channels;
      const double phase = across * static_cast<double>(pixel % width) +
                           down * static_cast<double>(pixel / width) + 0.5 * static_cast<double>(channel);
      shapes(p, 2 * i) = static_cast<float>(std::cos(phase)),
                    shapes(p, 2 * i + 1) = static_cast<float>(std::sin(phase));
    }
    double phase = rng.uniform(0, 6);
    for (Eigen::Index t = 0; t < frames; ++t) {
      phase += pace + 0.05 * rng.normal();
      courses(2 * i, t) = static_cast<float>(strength * std::cos(phase));
      courses(2 * i + 1, t) = static_cast<float>(strength * std::sin(phase));
    }
  }
  for (Eigen::Index t = 0; t < frames; ++t) {
    Eigen::VectorXf levels = (shapes * courses.col(t)).array() + 128;
    for (float& level : levels) level += static_cast<float>(rng.bits() % 16) / 2;
    clip.frames.emplace_back();
    cv::Mat(height, width, CV_MAKETYPE(CV_32F, channels), levels.data())
        .convertTo(clip.frames.back(), depth, white / 255);
  }
  return clip;
}

/// A row for each frame, as cv::PCA takes it; less the mean.
cv::Mat rows_of(const core::Clip& clip, bool centred) {
  cv::Mat rows;
  for (const cv::Mat& frame : clip.frames) rows.push_back(core::to_levels(frame, clip.info).reshape(1, 1));
  if (centred) {
    cv::Mat mean;
    cv::reduce(rows, mean, 0, cv::REDUCE_AVG);
    for (int t = 0; t < rows.rows; ++t) rows.row(t) -= mean;
  }
  return rows;
}

void learn_texture(benchmark::State& state, int channels, int frames, int depth) {
  const core::Clip clip = make_clip(320, 220, channels, frames, depth);
  dytex::LearnOptions options;
  options.components = kComponents;
  for (auto _ : state) {
    core::ClipSource source(clip);
    benchmark::DoNotOptimize(dytex::learn(source, options));
  }
}
BENCHMARK_CAPTURE(learn_texture, grey_100, 1, 100, CV_8U)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(learn_texture, grey_300, 1, 300, CV_8U)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(learn_texture, colour_100, 3, 100, CV_8U)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(learn_texture, colour_300, 3, 300, CV_8U)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(learn_texture, grey_100_floats, 1, 100, CV_32F)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void peer_eigen_svd(benchmark::State& state) {
  const cv::Mat rows = rows_of(make_clip(320, 220, 1, 100, CV_8U), true);
  const Eigen::Map<const Eigen::MatrixXf> frames(rows.ptr<float>(), rows.cols, rows.rows);
  for (auto _ : state) {
    const Eigen::BDCSVD<Eigen::MatrixXf> svd(frames, Eigen::ComputeThinU | Eigen::ComputeThinV);
    benchmark::DoNotOptimize(svd.singularValues().data());
  }
}
BENCHMARK(peer_eigen_svd)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(1);

void peer_opencv_pca(benchmark::State& state) {
  const cv::Mat rows = rows_of(make_clip(320, 220, 1, 100, CV_8U), false);
  for (auto _ : state)
    benchmark::DoNotOptimize(cv::PCA(rows, {}, cv::PCA::DATA_AS_ROW, kComponents).eigenvalues.data);
}
BENCHMARK(peer_opencv_pca)->Unit(benchmark::kMillisecond)->UseRealTime();

dytex::LinearDynamicTexture make_texture(int width, int height, int channels) {
  const Eigen::Index m = Eigen::Index{width} * height * channels, n = kComponents;
  core::Rng rng(2);
  dytex::LinearDynamicTexture texture;
  texture.info = {width, height, channels, CV_8U, 25, 255, n};
  texture.mean = Eigen::VectorXf::Constant(m, 128);
  texture.C.resize(m, n);
  for (float& c : texture.C.reshaped())
    c = static_cast<float>(rng.uniform(-1, 1) / std::sqrt(static_cast<double>(m) / 3));
  texture.A = 0.9 * Eigen::MatrixXd::Identity(n, n);
  texture.B = 20 * std::sqrt(static_cast<double>(m) / n) * Eigen::MatrixXd::Identity(n, n);
  texture.weights = Eigen::VectorXd::Ones(n);
  texture.states = Eigen::MatrixXd::Zero(n, n);
  texture.singular = Eigen::VectorXd::Zero(n);
  return texture;
}

/// As read from memory once for the eight frames.
void count_components(benchmark::State& state, const dytex::LinearDynamicTexture& texture) {
  state.SetItemsProcessed(state.iterations() * 8);
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(sizeof(float)) * texture.C.size());
}

void synthesize(benchmark::State& state, int width, int height, int channels) {
  const dytex::LinearDynamicTexture texture = make_texture(width, height, channels);
  dytex::Synthesis synthesis(texture, {});
  for (auto _ : state)
    for (int i = 0; i < 8; ++i) benchmark::DoNotOptimize(synthesis.next().data);
  count_components(state, texture);
}

/// Reading the components once: what no way of drawing eight frames from them can beat.
void read_components(benchmark::State& state, int width, int height, int channels) {
  const dytex::LinearDynamicTexture texture = make_texture(width, height, channels);
  constexpr Eigen::Index kBlock = 1 << 16;
  const auto* const bits = reinterpret_cast<const std::uint32_t*>(texture.C.data());
  for (auto _ : state)
    core::parallel_for(static_cast<std::size_t>(texture.C.size() / kBlock), {}, [&](std::size_t block) {
      const std::uint32_t* from = bits + static_cast<Eigen::Index>(block) * kBlock;
      std::uint32_t sum = 0;
      for (Eigen::Index i = 0; i < kBlock; ++i) sum += from[i];
      benchmark::DoNotOptimize(sum);
    });
  count_components(state, texture);
}

/// The drawing alone, on one thread, by instruction set: baseline, AVX2, AVX-512.
void draw_by_instructions(benchmark::State& state) {
  const auto isa = static_cast<dytex::detail::Isa>(state.range(0));
  if (isa > dytex::detail::best_isa()) return state.SkipWithError("this machine has no such instructions");
  const dytex::LinearDynamicTexture texture = make_texture(320, 220, 1);
  const Eigen::MatrixXf states = Eigen::MatrixXf::Random(8, kComponents);
  std::vector<std::vector<std::uint8_t>> frames(8, std::vector<std::uint8_t>(320 * 220));
  std::array<std::uint8_t*, 8> to{};
  for (std::size_t i = 0; i < 8; ++i) to[i] = frames[i].data();
  const dytex::detail::Batch batch{texture.mean.data(), texture.C.data(), texture.pixels(), kComponents,
                                   states.data()};
  for (auto _ : state) {
    for (Eigen::Index row = 0; row < texture.pixels(); row += 1024)
      dytex::detail::draw_bytes(batch, row, std::min<Eigen::Index>(1024, texture.pixels() - row), to, isa);
    benchmark::ClobberMemory();
  }
  count_components(state, texture);
}
BENCHMARK(draw_by_instructions)->Arg(0)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);

/// Frame by frame as the formula says it.
void peer_synthesize(benchmark::State& state, int width, int height, int channels) {
  const dytex::LinearDynamicTexture texture = make_texture(width, height, channels);
  Eigen::VectorXf x = Eigen::VectorXf::Ones(kComponents);
  for (auto _ : state)
    for (int i = 0; i < 8; ++i) {
      x *= 0.99F;
      Eigen::VectorXf y = texture.mean;
      y.noalias() += texture.C * x;
      cv::Mat bytes;
      cv::Mat(height, width, CV_MAKETYPE(CV_32F, channels), y.data()).convertTo(bytes, CV_8U);
      benchmark::DoNotOptimize(bytes.data);
    }
  state.SetItemsProcessed(state.iterations() * 8);
}
#define EMBERFOLD_DRAWN(run)                                                                                \
  BENCHMARK_CAPTURE(run, grey_320x220_8_frames, 320, 220, 1)->Unit(benchmark::kMillisecond)->UseRealTime(); \
  BENCHMARK_CAPTURE(run, colour_1280x720_8_frames, 1280, 720, 3)                                            \
      ->Unit(benchmark::kMillisecond)                                                                       \
      ->UseRealTime();                                                                                      \
  BENCHMARK_CAPTURE(run, colour_1920x1080_8_frames, 1920, 1080, 3)                                          \
      ->Unit(benchmark::kMillisecond)                                                                       \
      ->UseRealTime()
EMBERFOLD_DRAWN(synthesize);
EMBERFOLD_DRAWN(read_components);
EMBERFOLD_DRAWN(peer_synthesize);

}  // namespace
