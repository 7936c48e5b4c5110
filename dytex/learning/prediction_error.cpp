// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include "core/math/lbfgs.hpp"
#include "dytex/learning/decompositions.hpp"
#include "dytex/linear_dynamic_texture.hpp"
#include "dytex/model/innovations.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr int kMostSteps = 300;           // of L-BFGS
constexpr double kLeastGain = 1e-6;       // nats, in 10 steps: a smaller one ends the descent
constexpr double kMostRadius = 1 - 1e-9;  // spectral radius of A

using ConstMatrix = Eigen::Map<const Eigen::MatrixXd>;

/// F = A − K, K and x̂(0) in one vector.
struct Parameters {
  ConstMatrix F, K;
  Eigen::Map<const Eigen::VectorXd> first;
  Parameters(const Eigen::VectorXd& all, Eigen::Index n)
      : F(all.data(), n, n), K(all.data() + n * n, n, n), first(all.data() + 2 * n * n, n) {}
};

/// x̂(t+1) = F x̂(t) + K x(t).
Eigen::MatrixXd forecasts(const Eigen::MatrixXd& states, const Parameters& of) {
  Eigen::MatrixXd result(states.rows(), states.cols());
  result.col(0) = of.first;
  const Eigen::MatrixXd driven = of.K * states;
  for (Eigen::Index t = 1; t < states.cols(); ++t)
    result.col(t).noalias() = of.F * result.col(t - 1) + driven.col(t - 1);
  return result;
}

}  // namespace

Eigen::Index prediction_error_frames(Eigen::Index n) {
  return 4 * n + 2;  // twice as many numbers as parameters
}

PredictionError prediction_error_at(const Eigen::MatrixXd& V, const Eigen::VectorXd& parameters) {
  const Eigen::Index n = V.cols(), frames = V.rows();
  const Parameters of(parameters, n);
  const Eigen::MatrixXd states = V.transpose(), seen = forecasts(states, of);
  const Eigen::MatrixXd errors = (states - seen).rightCols(frames - 1);
  const double count = static_cast<double>(frames - 1);
  PredictionError result{std::numeric_limits<double>::infinity(), Eigen::VectorXd::Zero(parameters.size())};
  if (!errors.allFinite()) return result;
  const CholeskyFactors factors(errors * errors.transpose() / count);
  if (!factors.positive()) return result;
  result.value = factors.log_determinant();
  // Back through time: λ(t) = Fᵀ λ(t+1) − dvalue/de(t) is the slope by x̂(t).
  const Eigen::MatrixXd by_error = factors.solve(errors) * (2 / count);
  Eigen::MatrixXd lambda(n, frames);
  lambda.col(frames - 1) = -by_error.col(frames - 2);
  for (Eigen::Index t = frames - 2; t >= 0; --t) {
    lambda.col(t).noalias() = of.F.transpose() * lambda.col(t + 1);
    if (t > 0) lambda.col(t) -= by_error.col(t - 1);
  }
  Eigen::Map<Eigen::MatrixXd>(result.slope.data(), n, n).noalias() =
      lambda.rightCols(frames - 1) * seen.leftCols(frames - 1).transpose();
  Eigen::Map<Eigen::MatrixXd>(result.slope.data() + n * n, n, n).noalias() =
      lambda.rightCols(frames - 1) * states.leftCols(frames - 1).transpose();
  result.slope.tail(n) = lambda.col(0);
  return result;
}

std::optional<Innovations> prediction_error(const Eigen::MatrixXd& V, const Eigen::MatrixXd& start,
                                            const core::Context& context) {
  const Eigen::Index n = V.cols();
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(2 * n * n + n);
  Eigen::Map<Eigen::MatrixXd>(parameters.data() + n * n, n, n) = start;
  const core::detail::Gradient bounded =
      [&](const Eigen::VectorXd& at) -> std::pair<double, Eigen::VectorXd> {
    PredictionError error = prediction_error_at(V, at);
    const Parameters of(at, n);
    if (std::isfinite(error.value) && spectral_radius(of.F + of.K) >= kMostRadius)
      error.value = std::numeric_limits<double>::infinity();
    return {error.value, std::move(error.slope)};
  };
  parameters = core::detail::minimize_lbfgs(bounded, std::move(parameters), kMostSteps, kLeastGain, context);
  const Parameters found(parameters, n);
  Innovations result{found.F + found.K, found.K, forecasts(V.transpose(), found), 1, {}};
  return result;
}

}  // namespace emberfold::dytex::detail
