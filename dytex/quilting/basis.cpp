// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/basis.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "core/parallel.hpp"
#include "core/rng.hpp"
#include "dytex/learning/decompositions.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr Eigen::Index kSample = 4096;        // pixels that the basis is learned from
constexpr Eigen::Index kBlock = 512;          // rows or pixels of one task
constexpr Eigen::Index kExtraDirections = 8;  // of the random start (Halko, Martinsson, Tropp 2011: 5 to 10)
constexpr int kPowerRounds = 2;               // of subspace iteration (same paper: 1 or 2)
constexpr double kDependent = 1e-6;           // of a column's length: residual of a dependent one
constexpr double kLeastVariance = 1e-12;      // of the sum of all; directions below it are dropped

// Loads `count` pixels from `first` on, in chunk `chunk`, as columns of floats.
void load(const Trajectories& source, int chunk, std::size_t first, Eigen::Index count,
          Eigen::Ref<Eigen::MatrixXf> out) {
  const auto course = source.course();
  const auto convert = [&]<class T>(const T*) {
    const T* in = reinterpret_cast<const T*>(source.chunk(chunk)) + first * course;
    for (Eigen::Index i = 0; i < count; ++i, in += course)
      for (std::size_t j = 0; j < course; ++j)
        out(static_cast<Eigen::Index>(j), i) = static_cast<float>(in[j]);
  };
  if (source.info().depth == CV_8U) convert(static_cast<const std::uint8_t*>(nullptr));
  if (source.info().depth == CV_16U) convert(static_cast<const std::uint16_t*>(nullptr));
  if (source.info().depth == CV_32F) convert(static_cast<const float*>(nullptr));
}

// Trajectories as columns: of all pixels where there are few, else of pixels drawn at random.
Eigen::MatrixXf sample(std::span<const Trajectories* const> sources, std::uint64_t seed) {
  std::size_t pixels = 0;
  for (const auto* source : sources) pixels += source->pixels();
  const auto course = static_cast<Eigen::Index>(sources.front()->course());
  const auto count = std::min<Eigen::Index>(kSample, static_cast<Eigen::Index>(pixels));
  Eigen::MatrixXf columns(course * sources.front()->chunks(), count);
  core::Rng rng(seed, {0x6261u, 0, 0});
  for (Eigen::Index i = 0; i < count; ++i) {
    // One of each of `count` equal parts of all pixels.
    auto pixel = static_cast<std::size_t>((static_cast<double>(i) + rng.uniform()) *
                                          static_cast<double>(pixels) / static_cast<double>(count));
    pixel = std::min(pixel, pixels - 1);
    std::size_t s = 0;
    for (; pixel >= sources[s]->pixels(); ++s) pixel -= sources[s]->pixels();
    for (int c = 0; c < sources[s]->chunks(); ++c)
      load(*sources[s], c, pixel, 1, columns.block(c * course, i, course, 1));
  }
  return columns;
}

// a · b by blocks of a's rows, on all threads.
Eigen::MatrixXf product(const Eigen::Ref<const Eigen::MatrixXf>& a, const Eigen::MatrixXf& b) {
  if (a.cols() == 0) return Eigen::MatrixXf::Zero(a.rows(), b.cols());
  Eigen::MatrixXf out(a.rows(), b.cols());
  if (b.cols() == 0) return out;
  const auto blocks = static_cast<std::size_t>((a.rows() + kBlock - 1) / kBlock);
  core::parallel_for(blocks, {}, [&](std::size_t i) {
    const auto first = static_cast<Eigen::Index>(i) * kBlock, rows = std::min(kBlock, a.rows() - first);
    out.middleRows(first, rows).noalias() = a.middleRows(first, rows) * b;
  });
  return out;
}

// An orthonormal basis of the columns' span: Gram–Schmidt, twice; nearly dependent columns are dropped.
Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& columns) {
  Eigen::MatrixXd q(columns.rows(), columns.cols());
  Eigen::Index kept = 0;
  for (const auto& column : columns.colwise()) {
    Eigen::VectorXd v = column;
    for (int round = 0; round < 2; ++round) v -= q.leftCols(kept) * (q.leftCols(kept).transpose() * v).eval();
    const double norm = v.norm();
    if (norm > kDependent * column.norm() && norm > 0) q.col(kept++) = v / norm;
  }
  return q.leftCols(kept);
}

}  // namespace

Basis fit_basis(std::span<const Trajectories* const> sources, int components, std::uint64_t seed) {
  Basis basis;
  Eigen::MatrixXf columns = sample(sources, seed);
  basis.mean = columns.cast<double>().rowwise().mean().cast<float>();
  basis.complete = sources.front()->dimension() <= static_cast<std::size_t>(components);
  if (basis.complete) return basis;
  columns.colwise() -= basis.mean;
  const Eigen::MatrixXf turned = columns.transpose();
  Eigen::MatrixXf test(columns.cols(), components + kExtraDirections);
  core::Rng rng(seed, {0x6261u, 1, 0});
  for (float& value : test.reshaped()) value = static_cast<float>(rng.normal());
  Eigen::MatrixXd q = orthonormal(product(columns, test).cast<double>());
  for (int round = 0; round < kPowerRounds && q.cols() > 0; ++round)
    q = orthonormal(product(columns, product(turned, q.cast<float>())).cast<double>());
  const Eigen::MatrixXd seen = product(turned, q.cast<float>()).cast<double>();  // columns × directions
  const auto eigen = symmetric_eigen(seen.transpose() * seen);
  const Eigen::Index kept = std::min<Eigen::Index>(
      components, (eigen.values.array() > kLeastVariance * eigen.values.cwiseAbs().sum()).count());
  basis.directions = orthonormal(q * eigen.vectors.leftCols(kept)).cast<float>();
  return basis;
}

namespace {

// Returns the coefficients of some pixels from `first` on, and the norms of their residuals.
void project_pixels(const Trajectories& source, const Basis& basis, std::size_t first, Eigen::Index count,
                    std::vector<cv::Mat>& planes) {
  const auto course = static_cast<Eigen::Index>(source.course());
  const Eigen::Index k = basis.directions.cols();
  Eigen::MatrixXf values(course, count), coefficients = Eigen::MatrixXf::Zero(k, count);
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(count);
  for (int c = 0; c < source.chunks(); ++c) {
    load(source, c, first, count, values);
    values.colwise() -= basis.mean.segment(c * course, course);
    if (basis.complete) {
      const auto used = std::min<Eigen::Index>(course, static_cast<Eigen::Index>(planes.size()) - c * course);
      for (Eigen::Index j = 0; j < used; ++j)
        for (Eigen::Index i = 0; i < count; ++i)
          planes[static_cast<std::size_t>(c * course + j)].ptr<float>()[first + static_cast<std::size_t>(i)] =
              values(j, i);
      continue;
    }
    if (k > 0) coefficients.noalias() += basis.directions.middleRows(c * course, course).transpose() * values;
    squares += values.colwise().squaredNorm().transpose().cast<double>();
  }
  if (basis.complete) return;
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::size_t at = first + static_cast<std::size_t>(i);
    for (Eigen::Index j = 0; j < k; ++j)
      planes[static_cast<std::size_t>(j)].ptr<float>()[at] = coefficients(j, i);
    const double explained = k > 0 ? coefficients.col(i).cast<double>().squaredNorm() : 0;
    const double left = squares[i] - explained;
    planes.back().ptr<float>()[at] = static_cast<float>(std::sqrt(std::max(left, 0.0)));
  }
}

}  // namespace

std::vector<std::vector<cv::Mat>> project_trajectories(std::span<const Trajectories* const> sources,
                                                       const Basis& basis, const core::Context& context) {
  std::vector<std::vector<cv::Mat>> result;
  for (const auto* source : sources) {
    const std::size_t count =
        basis.complete ? source->dimension() : static_cast<std::size_t>(basis.directions.cols()) + 1;
    auto& planes = result.emplace_back(count);
    for (auto& plane : planes) plane = cv::Mat::zeros(source->size(), CV_32F);
    const auto pixels = source->pixels(), block = static_cast<std::size_t>(kBlock);
    core::parallel_for((pixels + block - 1) / block, context, [&](std::size_t i) {
      const auto n = std::min(block, pixels - i * block);
      project_pixels(*source, basis, i * block, static_cast<Eigen::Index>(n), planes);
    });
  }
  if (basis.complete) return result;
  const double usual = cv::mean(result.front().back())[0];
  for (auto& planes : result) planes.back() -= usual;  // smaller numbers, smaller rounding
  return result;
}

}  // namespace emberfold::dytex::detail
