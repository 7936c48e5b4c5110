// SPDX-License-Identifier: Apache-2.0
#include "dytex/learning/independent_noise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/math/robust.hpp"
#include "core/rng.hpp"
#include "dytex/learning/decompositions.hpp"

namespace emberfold::dytex::detail {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMostTurns = 200;
constexpr double kTurned = 1e-6;      // rad of a step that ends the search
constexpr double kFalseAlarm = 0.05;  // of a normal clip, for all of its inputs together
constexpr std::uint64_t kSeed = 1;    // of the rotation to begin from
constexpr int kShapes = 49;           // tried
constexpr double kLeastShape = 0.3, kMostShape = 8;
constexpr Index kSamplesPerInput = 8, kLeastSamples = 32;

MatrixXd random_rotation(Index k) {
  core::Rng rng(kSeed);
  MatrixXd normals(k, k);
  for (double& x : normals.reshaped()) x = rng.normal();
  return nearest_orthogonal(normals);
}

/// The density β / (2 α Γ(1/β)) exp(−(|x − μ| / α)^β).
struct GeneralisedNormal {
  double centre = 0, scale = 1, shape = 2;
  [[nodiscard]] double log_likelihood(const VectorXd& x) const {
    // NOLINTNEXTLINE(concurrency-mt-unsafe): its argument is positive, the shared sign is not read
    const double log_peak = std::log(shape / (2 * scale)) - std::lgamma(1 / shape);
    return static_cast<double>(x.size()) * log_peak - ((x.array() - centre).abs() / scale).pow(shape).sum();
  }
};

GeneralisedNormal fit_generalised_normal(const VectorXd& x) {
  GeneralisedNormal best;
  double most = -std::numeric_limits<double>::infinity();
  const double centre = core::median(std::vector<double>(x.begin(), x.end()));
  const Eigen::ArrayXd away = (x.array() - centre).abs();
  for (int i = 0; i < kShapes; ++i) {
    const double shape = kLeastShape * std::pow(kMostShape / kLeastShape, double(i) / (kShapes - 1));
    const GeneralisedNormal tried{centre, std::pow(shape * away.pow(shape).mean(), 1 / shape), shape};
    const double likelihood = tried.log_likelihood(x);
    if (tried.scale > 0 && likelihood > most) most = likelihood, best = tried;
  }
  return best;
}

/// Every second column, from `first` on.
MatrixXd every_second(const MatrixXd& v, Index first) {
  return v(Eigen::all, Eigen::seq(first, Eigen::last, 2));
}

}  // namespace

MatrixXd fast_ica(const MatrixXd& v, const MatrixXd& start, const core::Context& context) {
  MatrixXd R = start;
  const auto samples = static_cast<double>(v.cols());
  for (int step = 0; step < kMostTurns; ++step) {
    context.check();
    const MatrixXd bent = (R * v).array().tanh();
    const VectorXd slopes = 1 - bent.array().square().rowwise().mean();
    const MatrixXd next = nearest_orthogonal(bent * v.transpose() / samples - slopes.asDiagonal() * R);
    // Signs are free.
    const double least = next.cwiseProduct(R).rowwise().sum().cwiseAbs().minCoeff();
    R = next;
    if (least > std::cos(kTurned)) break;
  }
  return R;
}

double gain_over_normal(const VectorXd& earlier, const VectorXd& later) {
  const double variance = (later.array() - later.mean()).square().mean();
  if (!(variance > 0)) return 0;
  const double normal =
      -static_cast<double>(later.size()) / 2 * (std::log(2 * std::numbers::pi * variance) + 1);
  return fit_generalised_normal(earlier).log_likelihood(later) - normal;
}

Eigen::RowVectorXd standard_quantiles(const VectorXd& sample) {
  Eigen::RowVectorXd q = sample.transpose();
  std::sort(q.begin(), q.end());
  const Index gaps = q.size() - 1;
  const auto low = [&] { return q.head(gaps).array(); };
  const auto high = [&] { return q.tail(gaps).array(); };
  const double mean = (low() + high()).mean() / 2;
  q.array() -= mean;
  const double variance = (low().square() + low() * high() + high().square()).mean() / 3;
  return q / std::sqrt(variance);
}

std::optional<IndependentNoise> independent_noise(const MatrixXd& v, const core::Context& context) {
  const Index k = v.rows();
  if (k == 0 || v.cols() < kSamplesPerInput * k + kLeastSamples) return std::nullopt;
  const MatrixXd start = fast_ica(every_second(v, 0), random_rotation(k), context);
  const MatrixXd earlier = start * every_second(v, 0), later = start * every_second(v, 1);
  const double needed = std::log(static_cast<double>(k) / kFalseAlarm);
  std::vector<Index> order, normal;
  for (Index i = 0; i < k; ++i)
    (gain_over_normal(earlier.row(i), later.row(i)) > needed ? order : normal).push_back(i);
  if (order.empty()) return std::nullopt;
  const auto found = static_cast<Index>(order.size());
  order.insert(order.end(), normal.begin(), normal.end());
  const MatrixXd R = fast_ica(v, start, context);
  IndependentNoise result{R(order, Eigen::all), MatrixXd(found, v.cols())};
  const MatrixXd sources = result.turn.topRows(found) * v;
  for (Index i = 0; i < found; ++i) result.marginals.row(i) = standard_quantiles(sources.row(i));
  return result;
}

}  // namespace emberfold::dytex::detail
