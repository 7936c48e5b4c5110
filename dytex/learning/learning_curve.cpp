// SPDX-License-Identifier: Apache-2.0
#include "dytex/learning/learning_curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <Eigen/Core>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/text/check_range.hpp"
#include "dytex/learning/decompositions.hpp"
#include "dytex/learning/dynamics.hpp"
#include "dytex/learning/frame_blocks.hpp"
#include "dytex/learning/gram.hpp"

namespace emberfold::dytex {

namespace {

/// Squared errors of the forecast of one frame.
struct Miss {
  double all = 0, left_out = 0;
};

/// Error of the forecast of frame `target` from the `length` frames before it.
Miss forecast_miss(const Eigen::MatrixXd& gram, Eigen::Index target, Eigen::Index length,
                   Eigen::Index components) {
  const Eigen::Index first = target - length;
  const Eigen::MatrixXd window = gram.block(first, first, length, length);
  const Eigen::VectorXd with_target = gram.block(first, target, length, 1);
  const Eigen::VectorXd means = window.rowwise().mean();
  // Products of the centred frames with y − ȳ, and its square.
  Eigen::VectorXd products = with_target - means;
  products.array() -= products.mean();
  const double square = gram(target, target) - 2 * with_target.mean() + means.mean();
  const detail::SymmetricEigen eigen = detail::symmetric_eigen(detail::centred(window));
  const double least =
      8 * static_cast<double>(length) * std::numeric_limits<double>::epsilon() * window.diagonal().maxCoeff();
  const Eigen::Index n = std::min<Eigen::Index>(components, (eigen.values.array() > least).count());
  const Eigen::VectorXd s = eigen.values.head(n).cwiseSqrt();
  const Eigen::MatrixXd V = eigen.vectors.leftCols(n);
  const Eigen::VectorXd x = (V.transpose() * products).cwiseQuotient(s);
  const detail::Dynamics dynamics = detail::fit_dynamics({s, V}, {});
  const Eigen::VectorXd last = s.cwiseProduct(V.row(length - 1).transpose());
  Miss result;
  result.left_out = std::max(square - x.squaredNorm(), 0.0);
  result.all = result.left_out + (x - dynamics.A * last).squaredNorm();
  return result;
}

std::vector<int> choose_targets(int frames, int count) {
  const int span = std::max(frames / 4, 1), kept = std::min(count, span);
  std::vector<int> targets;
  for (int j = kept - 1; j >= 0; --j) targets.push_back(frames - 1 - j * (span / kept));
  return targets;
}

std::vector<int> choose_lengths(int shortest, int longest, int count) {
  std::vector<int> lengths;
  for (int i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / (count - 1);
    const int length = shortest + static_cast<int>(std::lround(share * (longest - shortest)));
    if (lengths.empty() || length > lengths.back()) lengths.push_back(length);
  }
  return lengths;
}

/// The smoothed error at point i: the mean with its neighbours.
double smooth_error(const std::vector<CurvePoint>& points, std::size_t i) {
  const std::size_t first = i > 0 ? i - 1 : 0, last = std::min(i + 1, points.size() - 1);
  double sum = 0;
  for (std::size_t k = first; k <= last; ++k) sum += points[k].error;
  return sum / static_cast<double>(last - first + 1);
}

void find_plateau(LearningCurve& curve, double tolerance) {
  const auto& points = curve.points;
  const std::size_t tail = points.size() - std::max<std::size_t>(points.size() / 4, 1);
  double sum = 0;
  for (std::size_t i = tail; i < points.size(); ++i) sum += points[i].error;
  curve.plateau = sum / static_cast<double>(points.size() - tail);
  std::size_t from = points.size();
  while (from > 0 && smooth_error(points, from - 1) <= (1 + tolerance) * curve.plateau) --from;
  if (from < tail) curve.critical = points[from].length;
}

/// The products of all pairs of frames, levels², and the number of values in a frame.
struct ClipGram {
  Eigen::MatrixXd products;  // τ × τ
  std::size_t values = 0;
};
ClipGram read_gram(core::FrameSource& source, const CurveOptions& options, const core::Context& context) {
  detail::FrameBlocks frame_blocks(source, options.memory, detail::kMostFrames, context);
  const auto frames = static_cast<Eigen::Index>(frame_blocks.frames());
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(frames, frames);
  const auto add = [&](std::size_t, const detail::FrameValues& band) {
    detail::add_gram(band, gram, context);
  };
  frame_blocks.for_each("comparing frames", false, add, context);
  gram =
      (gram.selfadjointView<Eigen::Lower>().toDenseMatrix() * std::pow(255 / source.info().white, 2)).eval();
  if (!gram.allFinite()) throw core::InputError("the clip has a value that is not finite");
  return {gram, frame_blocks.values()};
}

CurvePoint point_of(int length, const Miss* misses, std::size_t count, double values) {
  CurvePoint point{length};
  double squares = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double error = std::sqrt(misses[i].all / values);
    point.error += error / static_cast<double>(count);
    squares += error * error / static_cast<double>(count);
    point.left_out += std::sqrt(misses[i].left_out / values) / static_cast<double>(count);
  }
  point.spread = std::sqrt(std::max(squares - point.error * point.error, 0.0));
  return point;
}

}  // namespace

void CurveOptions::validate() const {
  core::check_at_least("CurveOptions.components", components, 1);
  core::check_range("CurveOptions.lengths", lengths, 2, 1000);
  core::check_range("CurveOptions.targets", targets, 1, 1000);
  core::check_at_least("CurveOptions.longest", longest, 1);
  core::check_above("CurveOptions.tolerance", tolerance, 0);
  core::check_at_least("CurveOptions.memory", static_cast<double>(memory), detail::kLeastMemory);
}

LearningCurve learning_curve(core::FrameSource& source, const CurveOptions& options,
                             const core::Context& context) {
  options.validate();
  LearningCurve curve;
  const auto [gram, values] = read_gram(source, options, context);
  const int frames = static_cast<int>(gram.rows()), shortest = options.components + 2;
  curve.targets = choose_targets(frames, options.targets);
  const int longest = std::min(curve.targets.front(), options.longest);
  if (longest <= shortest)
    throw core::InputError("components is " + std::to_string(options.components) + "; windows of the " +
                           std::to_string(frames) + " frames have at most " + std::to_string(longest) +
                           " frames, so allowed is 1 to " + std::to_string(std::max(longest - 3, 0)));
  const std::vector<int> lengths = choose_lengths(shortest, longest, options.lengths);
  const std::size_t count = curve.targets.size();
  std::vector<Miss> misses(lengths.size() * count);
  // Longest first: they take longest.
  core::parallel_for(misses.size(), context, [&, &gram = gram](std::size_t k) {
    const std::size_t i = misses.size() - 1 - k;
    misses[i] = forecast_miss(gram, curve.targets[i % count], lengths[i / count], options.components);
  });
  for (std::size_t i = 0; i < lengths.size(); ++i)
    curve.points.push_back(point_of(lengths[i], &misses[i * count], count, static_cast<double>(values)));
  for (const int t : curve.targets)
    curve.frame_before += std::sqrt(std::max(gram(t, t) - 2 * gram(t, t - 1) + gram(t - 1, t - 1), 0.0) /
                                    static_cast<double>(values)) /
                          static_cast<double>(count);
  find_plateau(curve, options.tolerance);
  return curve;
}

}  // namespace emberfold::dytex
