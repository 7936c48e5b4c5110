// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "core/context.hpp"

namespace emberfold::dytex::detail {

/// x(t) = x̂(t) + e(t),  x̂(t+1) = A x̂(t) + K e(t): x as measured, x̂ its forecast from all before.
struct Innovations {
  Eigen::MatrixXd A, K;       ///< n × n, A stable
  Eigen::MatrixXd forecasts;  ///< n × τ: x̂
  Eigen::Index first = 0;     ///< the first frame whose e counts: before, the forecast knew too little
  std::string note;           ///< where something was not taken as it came
};

/// Least number of frames for n components.
Eigen::Index n4sid_frames(Eigen::Index n);
Eigen::Index prediction_error_frames(Eigen::Index n);

/// Stochastic subspace identification (Van Overschee, De Moor 1993, their algorithm 2 without weights) of V's
/// rows as outputs, with as many states as outputs and as much past as the clip allows, at most 10 frames.
/// Where A is not stable, that of the extended observability matrix with zeros behind it is taken, and the
/// note says so. Nothing where the outputs do not show the states. V: τ × n, of unit size. O(τ (n · past)² +
/// (n · past)³).
std::optional<Innovations> n4sid(const Eigen::MatrixXd& V);

/// The innovations form of least log det Σ e eᵀ (the most likely one for normal noise), from A with K = A on,
/// which is the auto-regression: its error is never above that one's. By L-BFGS, the slope by one pass back
/// through time; A stays stable. V: τ × n, of unit size; `start` is stable. O(τ n²) + O(n³) a step, at most
/// 300.
std::optional<Innovations> prediction_error(const Eigen::MatrixXd& V, const Eigen::MatrixXd& start,
                                            const core::Context& context);

/// log det of the mean of e eᵀ over frames 1 … τ − 1, and its slope by A − K, K and x̂(0) in this order,
/// columns of matrices one behind the other; infinite where forecasts leave all bounds.
struct PredictionError {
  double value = 0;
  Eigen::VectorXd slope;
};
PredictionError prediction_error_at(const Eigen::MatrixXd& V, const Eigen::VectorXd& parameters);

}  // namespace emberfold::dytex::detail
