// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "core/context.hpp"

namespace emberfold::dytex::detail {

/// The innovations form x(t) = x̂(t) + e(t),  x̂(t+1) = A x̂(t) + K e(t): x as measured, x̂ its forecast.
struct Innovations {
  Eigen::MatrixXd A, K;       ///< n × n, A stable
  Eigen::MatrixXd forecasts;  ///< n × τ: x̂
  Eigen::Index first = 0;     ///< the first frame whose e counts: earlier forecasts knew too little
  std::string note;           ///< describes a replacement, if any
};

/// Returns the least number of frames for n components.
Eigen::Index n4sid_frames(Eigen::Index n);
Eigen::Index prediction_error_frames(Eigen::Index n);

/// Identifies an innovations form with V's rows as outputs by stochastic subspaces.
/// Van Overschee, De Moor 1993, algorithm 2 without weights, with as many states as outputs and as much past
/// as the clip allows, at most 10 frames. An unstable A is replaced by that of the extended observability
/// matrix with zeros after it, and the note says so. None where the outputs do not determine the states. V:
/// τ × n, of unit size. O(τ (n · past)² + (n · past)³).
std::optional<Innovations> n4sid(const Eigen::MatrixXd& V);

/// Finds the innovations form of least log det Σ e eᵀ, the most likely one for normal noise. Begun at the
/// auto-regression (K = A), whose error is never exceeded. By L-BFGS, the slope by one pass back
/// through time; A stays stable. V: τ × n, of unit size; `start` is stable. O(τ n²) + O(n³) a step, at most
/// 300.
std::optional<Innovations> prediction_error(const Eigen::MatrixXd& V, const Eigen::MatrixXd& start,
                                            const core::Context& context);

/// The value log det of the mean of e eᵀ over frames 1 … τ − 1, and its slope by A − K, K and x̂(0) in this
/// order, columns of matrices one after the other. Infinite where forecasts overflow.
struct PredictionError {
  double value = 0;
  Eigen::VectorXd slope;
};
PredictionError prediction_error_at(const Eigen::MatrixXd& V, const Eigen::VectorXd& parameters);

}  // namespace emberfold::dytex::detail
