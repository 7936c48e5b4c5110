// SPDX-License-Identifier: Apache-2.0
// Learning linear dynamic textures of 50 components, and drawing frames from one; and what else could do it.
// On as many threads as there are, the peers as they come. peers_dytex.py sets numpy and scipy beside it.
#include <cmath>
#include <vector>

#include <Eigen/SVD>
#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>

#include "core/rng.hpp"
#include "dytex/learn.hpp"
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

void synthesize(benchmark::State& state, int width, int height, int channels) {
  const dytex::LinearDynamicTexture texture = make_texture(width, height, channels);
  dytex::Synthesis synthesis(texture, {});
  for (auto _ : state)
    for (int i = 0; i < 8; ++i) benchmark::DoNotOptimize(synthesis.next().data);
  state.SetItemsProcessed(state.iterations() * 8);
}
BENCHMARK_CAPTURE(synthesize, grey_320x240_8_frames, 320, 240, 1)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(synthesize, colour_1280x720_8_frames, 1280, 720, 3)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

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
BENCHMARK_CAPTURE(peer_synthesize, grey_320x240_8_frames, 320, 240, 1)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(peer_synthesize, colour_1280x720_8_frames, 1280, 720, 3)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
