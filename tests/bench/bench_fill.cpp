// SPDX-License-Identifier: Apache-2.0
// Filling one frame of which a fifth is held in bands along curves, on one thread; and what else could do it.
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/SparseCholesky>
#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#ifdef EMBERFOLD_BENCH_PHOTO
#include <opencv2/photo.hpp>
#endif

#include "core/rng.hpp"
#include "sketch/inpainting/fill.hpp"

using namespace emberfold;

namespace {

struct Frame {
  cv::Mat levels;  // soft blobs with some grain
  cv::Mat mask;
};

/// Bands three pixels wide along arcs, until they cover a fifth.
Frame make_frame(cv::Size size, int channels) {
  core::Rng rng(1);
  Frame frame{cv::Mat(size, CV_32FC(channels)), cv::Mat(size, CV_8U, cv::Scalar(0))};
  for (int i = 0; i < frame.levels.rows; ++i)
    for (int j = 0; j < frame.levels.cols * channels; ++j)
      frame.levels.ptr<float>(i)[j] = static_cast<float>(rng.uniform(0, 255));
  cv::GaussianBlur(frame.levels, frame.levels, {}, 5);
  cv::normalize(frame.levels, frame.levels, 0, 255, cv::NORM_MINMAX);
  while (cv::countNonZero(frame.mask) < size.area() / 5) {
    double x = rng.uniform(0, size.width), y = rng.uniform(0, size.height), a = rng.uniform(0, 6.283);
    const double bend = rng.uniform(-0.2, 0.2);
    std::vector<cv::Point> points;
    for (int k = 0; k < 50; ++k, x += 3 * std::cos(a), y += 3 * std::sin(a), a += bend)
      points.emplace_back(static_cast<int>(x), static_cast<int>(y));
    cv::polylines(frame.mask, points, false, 255, 3);
  }
  return frame;
}

cv::Mat factorised(const Frame& frame) {
  const int width = frame.mask.cols, height = frame.mask.rows;
  cv::Mat number(frame.mask.size(), CV_32S, cv::Scalar(-1));
  int unknowns = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (frame.mask.at<uchar>(y, x) == 0) number.at<int>(y, x) = unknowns++;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(unknowns) * 5);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int i = number.at<int>(y, x);
      if (i < 0) continue;
      int degree = 0;
      for (const auto& [nx, ny] : {std::pair{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}}) {
        if (nx < 0 || ny < 0 || nx >= width || ny >= height) continue;
        ++degree;
        if (number.at<int>(ny, nx) >= 0)
          entries.emplace_back(i, number.at<int>(ny, nx), -1.0);
        else
          right[i] += static_cast<double>(frame.levels.at<float>(ny, nx));
      }
      entries.emplace_back(i, i, degree);
    }
  Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  const Eigen::VectorXd solution = solver.solve(right);
  cv::Mat result = frame.levels.clone();
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (number.at<int>(y, x) >= 0)
        result.at<float>(y, x) = static_cast<float>(solution[number.at<int>(y, x)]);
  return result;
}

cv::Size size_of(const benchmark::State& state) {
  return {static_cast<int>(state.range(0)), static_cast<int>(state.range(1))};
}

void fill_frame(benchmark::State& state, int channels) {
  const Frame frame = make_frame(size_of(state), channels);
  sketch::FillResult result;
  for (auto _ : state) {
    result = sketch::fill(frame.levels, frame.mask);
    benchmark::DoNotOptimize(result.levels.data);
  }
  state.counters["iterations_cg"] = result.iterations;
  state.counters["share"] = cv::countNonZero(frame.mask) / static_cast<double>(frame.mask.total());
  if (channels == 1) state.counters["max_error"] = cv::norm(result.levels, factorised(frame), cv::NORM_INF);
}
void fill_grey(benchmark::State& state) {
  fill_frame(state, 1);
}
void fill_colour(benchmark::State& state) {
  fill_frame(state, 3);
}

void fill_eigen_ldlt(benchmark::State& state) {
  const Frame frame = make_frame(size_of(state), 1);
  for (auto _ : state) benchmark::DoNotOptimize(factorised(frame).data);
}

#ifdef EMBERFOLD_BENCH_PHOTO
void inpaint(benchmark::State& state, int method) {
  const Frame frame = make_frame(size_of(state), 1);
  cv::Mat bytes, holes = frame.mask == 0, result;
  frame.levels.convertTo(bytes, CV_8U);
  cv::setNumThreads(1);
  for (auto _ : state) {
    cv::inpaint(bytes, holes, result, 3, method);
    benchmark::DoNotOptimize(result.data);
  }
}
void fill_opencv_ns(benchmark::State& state) {
  inpaint(state, cv::INPAINT_NS);
}
void fill_opencv_telea(benchmark::State& state) {
  inpaint(state, cv::INPAINT_TELEA);
}
#endif

void both_sizes(benchmark::internal::Benchmark* b) {
  b->Args({320, 240})->Args({1280, 720})->Unit(benchmark::kMillisecond);
}

BENCHMARK(fill_grey)->Apply(both_sizes);
BENCHMARK(fill_colour)->Apply(both_sizes);
BENCHMARK(fill_eigen_ldlt)->Apply(both_sizes);
#ifdef EMBERFOLD_BENCH_PHOTO
BENCHMARK(fill_opencv_ns)->Apply(both_sizes);
BENCHMARK(fill_opencv_telea)->Apply(both_sizes);
#endif

}  // namespace
