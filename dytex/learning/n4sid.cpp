// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "dytex/learning/decompositions.hpp"
#include "dytex/linear_dynamic_texture.hpp"
#include "dytex/model/innovations.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr Eigen::Index kLeastPast = 2, kMostPast = 10;  // frames of past and of future
constexpr int kMostRiccatiSteps = 2000;
constexpr double kRiccatiTolerance = 1e-12;   // relative change of the covariance
constexpr double kLeastObservability = 1e-6;  // singular value, of the largest: below it a state is hidden

/// Stacks outputs of `count` frames from `first` on, for `columns` frames one after another.
Eigen::MatrixXd hankel(const Eigen::MatrixXd& V, Eigen::Index first, Eigen::Index count,
                       Eigen::Index columns) {
  const Eigen::Index n = V.cols();
  Eigen::MatrixXd result(count * n, columns);
  for (Eigen::Index k = 0; k < count; ++k)
    result.middleRows(k * n, n) = V.middleRows(first + k, columns).transpose();
  return result;
}

/// Projects the future's rows on the past's.
Eigen::MatrixXd project_future(const Eigen::MatrixXd& future, const Eigen::MatrixXd& past) {
  const Eigen::MatrixXd Q = thin_q(past.transpose());
  return future * Q * Q.transpose();
}

/// The most frames of past with twice as many columns as rows of past, 2 … 10.
Eigen::Index past_length(Eigen::Index frames, Eigen::Index n) {
  return std::clamp<Eigen::Index>((frames + 1) / (2 * n + 2), kLeastPast, kMostPast);
}

/// K of the steady state of x(t+1) = A x + w, y = x + e, cov(w, e) = (Q, S; Sᵀ, R): the Riccati recursion.
Eigen::MatrixXd steady_gain(const Eigen::MatrixXd& A, const Eigen::MatrixXd& Q, const Eigen::MatrixXd& S,
                            const Eigen::MatrixXd& R) {
  Eigen::MatrixXd P = Q, gain;
  for (int step = 0; step < kMostRiccatiSteps; ++step) {
    const Eigen::MatrixXd cross = A * P + S;
    gain = right_divide(cross, P + R);
    Eigen::MatrixXd next = A * P * A.transpose() + Q - gain * cross.transpose();
    next = ((next + next.transpose()) / 2).eval();
    const bool settled = (next - P).norm() <= kRiccatiTolerance * next.norm();
    P = std::move(next);
    if (settled) break;
  }
  return gain;
}

Eigen::MatrixXd filter_states(const Eigen::MatrixXd& V, const Eigen::MatrixXd& A, const Eigen::MatrixXd& K) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(V.cols(), V.rows());
  for (Eigen::Index t = 1; t < V.rows(); ++t)
    result.col(t) = A * result.col(t - 1) + K * (V.row(t - 1).transpose() - result.col(t - 1));
  return result;
}

}  // namespace

Eigen::Index n4sid_frames(Eigen::Index n) {
  return 4 * n + 3;  // a past of two frames, and as many columns as rows of past
}

std::optional<Innovations> n4sid(const Eigen::MatrixXd& V) {
  const Eigen::Index n = V.cols(), past = past_length(V.rows(), n), columns = V.rows() - 2 * past + 1;
  // The states at the start of the future, and one frame on: Γ⁺ times the predictions.
  const ThinSvd svd = thin_svd(project_future(hankel(V, past, past, columns), hankel(V, 0, past, columns)));
  if (svd.s[n - 1] <= kLeastObservability * svd.s[0]) return std::nullopt;
  const Eigen::MatrixXd observability = svd.U.leftCols(n) * svd.s.head(n).cwiseSqrt().asDiagonal(),
                        states = svd.s.head(n).cwiseSqrt().asDiagonal() * svd.V.leftCols(n).transpose();
  const Eigen::MatrixXd shorter = observability.topRows((past - 1) * n);
  const Eigen::MatrixXd next = least_squares(
      shorter, project_future(hankel(V, past + 1, past - 1, columns), hankel(V, 0, past + 1, columns)));
  const Eigen::MatrixXd outputs = V.middleRows(past, columns).transpose();
  // (A; C) by least squares, then states as the outputs show them: C becomes the identity.
  Eigen::MatrixXd A = least_squares(states.transpose(), next.transpose()).transpose();
  const Eigen::MatrixXd C = least_squares(states.transpose(), outputs.transpose()).transpose();
  const Eigen::VectorXd shown = thin_svd(C).s;
  if (shown[n - 1] <= kLeastObservability * shown[0]) return std::nullopt;
  Innovations result;
  if (const double radius = spectral_radius(A); !(radius < 1)) {
    result.note = "the subspaces' transition is not stable (spectral radius " + std::to_string(radius) +
                  "): the stable one of a closed observability matrix is taken";
    Eigen::MatrixXd shifted = Eigen::MatrixXd::Zero(observability.rows(), n);
    shifted.topRows((past - 1) * n) = observability.bottomRows((past - 1) * n);
    A = least_squares(observability, shifted);
  }
  const Eigen::MatrixXd off = C * (next - A * states), e = outputs - C * states;
  const double count = static_cast<double>(columns);
  result.A = C * A * inverse(C);
  try {
    result.K = steady_gain(result.A, off * off.transpose() / count, off * e.transpose() / count,
                           e * e.transpose() / count);
  } catch (const core::NumericalError&) {  // the outputs leave no residual
    return std::nullopt;
  }
  if (!result.K.allFinite() || !(spectral_radius(result.A) < 1)) return std::nullopt;
  result.forecasts = filter_states(V, result.A, result.K);
  result.first = past;
  return result;
}

}  // namespace emberfold::dytex::detail
