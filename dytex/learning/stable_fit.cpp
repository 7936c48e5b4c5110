// SPDX-License-Identifier: Apache-2.0
#include "dytex/learning/stable_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dytex/learning/decompositions.hpp"
#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr int kMostDescents = 1000;     // of each of the two descents
constexpr double kLeastStep = 1e-12;    // length below which a line search gives up
constexpr int kGainWindow = 20;         // steps over which the gain is measured
constexpr double kLeastDescent = 1e-7;  // relative, over the window: a smaller one ends the descent
constexpr double kFirstPace = 0.5;      // of the fast gradient
constexpr double kStepGrowth = 1.5;     // of the step length after a step that went down
constexpr double kStartShrink = 0.99;   // of the bound, to which the least-squares start is scaled

/// Clips the eigenvalues of a symmetric matrix to 0 … `most`.
Eigen::MatrixXd clip_eigenvalues(const Eigen::MatrixXd& matrix, double most) {
  const SymmetricEigen eigen = symmetric_eigen((matrix + matrix.transpose()) / 2);
  return eigen.vectors * eigen.values.cwiseMax(0).cwiseMin(most).asDiagonal() * eigen.vectors.transpose();
}

StableForm step_along(const StableForm& from, const StableForm& along, double length) {
  return {from.S + length * along.S, from.O + length * along.O, from.C + length * along.C};
}

StableForm difference(const StableForm& a, const StableForm& b) {
  return step_along(a, b, -1);
}

StableForm project_form(const StableForm& form, double most) {
  return {form.S, nearest_orthogonal(form.O), clip_eigenvalues(form.C, most)};
}

/// Returns, S given, the O and C nearest to S A S⁻¹.
StableForm form_of(const Eigen::MatrixXd& A, const Eigen::MatrixXd& S, double most) {
  const ThinSvd svd = thin_svd(S * A * inverse(S));  // U s Vᵀ = (U Vᵀ)(V s Vᵀ)
  return {S, svd.U * svd.V.transpose(),
          clip_eigenvalues(svd.V * svd.s.asDiagonal() * svd.V.transpose(), most)};
}

struct Descent {
  StableForm form;
  double error = 0;
};

/// Fast gradient, restarted from the current point whenever it would go up.
Descent descend(const StableObjective& objective, StableForm start, double most,
                const core::Context& context) {
  Descent best{std::move(start), 0};
  best.error = objective(best.form.matrix());
  StableForm ahead = best.form;
  bool is_ahead = false;
  double length = 1, pace = kFirstPace, before = best.error;
  for (int step = 1; step <= kMostDescents; ++step) {
    context.check();
    const StableForm slope = objective.gradient(ahead);
    Descent next;
    for (;;) {
      next.form = project_form(step_along(ahead, slope, -length), most);
      next.error = objective(next.form.matrix());
      if (next.error < best.error || length < kLeastStep || is_ahead) break;
      length /= 2;
    }
    if (!(next.error < best.error)) {
      if (!is_ahead) break;  // nothing lower along the slope
      ahead = best.form, is_ahead = false, pace = kFirstPace;
      continue;
    }
    const double next_pace = (std::sqrt(std::pow(pace, 4) + 4 * pace * pace) - pace * pace) / 2;
    ahead = step_along(next.form, difference(next.form, best.form),
                       pace * (1 - pace) / (pace * pace + next_pace));
    is_ahead = true, pace = next_pace;
    best = std::move(next);
    length *= kStepGrowth;
    if (step % kGainWindow != 0) continue;
    if (before - best.error <= kLeastDescent * best.error) break;
    before = best.error;
  }
  return best;
}

}  // namespace

Eigen::MatrixXd StableForm::matrix() const {
  return inverse(S) * O * C * S;
}

StableObjective::StableObjective(const Eigen::VectorXd& s, const Eigen::MatrixXd& V)
    : squares((s / s[0]).cwiseAbs2()) {
  const Eigen::Index gaps = V.rows() - 1;
  gamma = V.bottomRows(gaps).transpose() * V.topRows(gaps);
  first = V.topRows(gaps).transpose() * V.topRows(gaps);
  constant = (V.bottomRows(gaps).colwise().squaredNorm() * squares)(0) / 2;
}

double StableObjective::operator()(const Eigen::MatrixXd& A) const {
  if (!A.allFinite()) return std::numeric_limits<double>::infinity();
  return constant + (squares.asDiagonal() * A).cwiseProduct(A * first / 2 - gamma).sum();
}

StableForm StableObjective::gradient(const StableForm& form) const {
  const Eigen::MatrixXd inverse_S = inverse(form.S), OC = form.O * form.C, A = inverse_S * OC * form.S;
  const Eigen::MatrixXd slope = squares.asDiagonal() * (A * first - gamma);  // df/dA
  const Eigen::MatrixXd Z = slope.transpose() * inverse_S;
  return {(Z * OC - A * Z).transpose(), (form.C * form.S * Z).transpose(), (form.S * Z * form.O).transpose()};
}

Eigen::MatrixXd stable_fit(const Eigen::VectorXd& s, const Eigen::MatrixXd& V, const core::Context& context) {
  const Eigen::Index n = V.cols();
  const double most = 1 - 1 / (10 * static_cast<double>(V.rows()));
  const Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(n, n);
  const StableObjective objective(s, V);
  Descent best = descend(objective, form_of(objective.gamma, unit, most), most, context);
  // ‖S A S⁻¹‖ ≤ 1 with SᵀS = Σ (Aᵀ)ᵏ Aᵏ, for the least-squares A made stable.
  const Eigen::MatrixXd least = right_divide(objective.gamma, objective.first);
  const Eigen::MatrixXd smaller =
      least * (kStartShrink * most / std::max(spectral_radius(least), kStartShrink * most));
  const SymmetricEigen eigen = symmetric_eigen(stationary_covariance(smaller.transpose(), unit));
  const Eigen::MatrixXd S =
      eigen.vectors * (eigen.values / eigen.values[0]).cwiseSqrt().asDiagonal() * eigen.vectors.transpose();
  Descent other = descend(objective, form_of(smaller, S, most), most, context);
  if (other.error < best.error) best = std::move(other);
  return best.form.matrix();
}

}  // namespace emberfold::dytex::detail
