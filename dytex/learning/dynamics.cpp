// SPDX-License-Identifier: Apache-2.0
#include "dytex/learning/dynamics.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/text/format_number.hpp"
#include "dytex/learning/decompositions.hpp"
#include "dytex/linear_dynamic_texture.hpp"
#include "dytex/model/innovations.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr double kLeastNoise = 1e-6;  // of the states' size; smaller residuals are rounding
constexpr double kUndamped = 1e-6;    // of a pole's radius from 1: rounding of the frames
constexpr double kHeldRadius = 1 - 1e-9;
constexpr int kDoublings = 20;          // a mean over 2^20 frames
constexpr double kVarianceRatio = 1.5;  // drawn to learned; beyond it a note warns

/// A fit in states of unit size.
struct Fit {
  Eigen::MatrixXd A, states;  ///< of the whole state
  Eigen::MatrixXd noise;      ///< F with F Fᵀ the noise's covariance; of the components, which it enters
};

Fit regression_of(const Eigen::MatrixXd& V, const Eigen::MatrixXd& A) {
  const Eigen::Index gaps = V.rows() - 1;
  const Eigen::MatrixXd past = V.topRows(gaps);
  return {A, V.transpose(),
          (V.bottomRows(gaps).transpose() - A * past.transpose()) / std::sqrt(static_cast<double>(gaps))};
}

Fit least_squares_fit(const Eigen::MatrixXd& V) {
  const Eigen::Index gaps = V.rows() - 1;
  return regression_of(V, least_squares(V.topRows(gaps), V.bottomRows(gaps)).transpose());
}

/// Fits with zeros before and after the clip: always stable, and F Fᵀ = P − A P Aᵀ, P the data's covariance.
Fit yule_walker_fit(const Eigen::MatrixXd& V) {
  const Eigen::Index n = V.cols(), frames = V.rows();
  Eigen::MatrixXd past = Eigen::MatrixXd::Zero(frames + 1, n), next = past;
  past.bottomRows(frames) = V;
  next.topRows(frames) = V;
  Fit fit = regression_of(V, next.transpose() * past);  // the states' covariance is the identity
  fit.noise = (next.transpose() - fit.A * past.transpose()) / std::sqrt(static_cast<double>(frames));
  return fit;
}

bool is_noiseless(const Fit& fit) {
  // A state of unit size has the variance 1/τ.
  return fit.noise.norm() <= kLeastNoise / std::sqrt(static_cast<double>(fit.states.cols()));
}

/// Returns whether a fit is of waves that neither grow nor fade, but for rounding. Few frames fit any A.
bool is_undamped(const Fit& fit) {
  return fit.states.cols() > 2 * fit.A.rows() && is_noiseless(fit) &&
         ((eigenvalues(fit.A).cwiseAbs().array() - 1).abs() < kUndamped).all();
}

/// Brings A of undamped waves just below the radius 1, with F Fᵀ = (1 − ρ²) M: its stationary covariance M is
/// that of the waves, the mean of Aᵗ P Aᵗᵀ. None where they have no such mean.
std::optional<Fit> undamped_fit(Fit fit) {
  const Eigen::MatrixXd P = fit.states * fit.states.transpose() / static_cast<double>(fit.states.cols());
  Eigen::MatrixXd M = P, power = fit.A;
  for (int i = 0; i < kDoublings; ++i) {
    M = ((M + power * M * power.transpose()) / 2).eval();
    power = (power * power).eval();
  }
  if (!(M.trace() < kVarianceRatio * P.trace())) return std::nullopt;
  fit.A *= kHeldRadius / spectral_radius(fit.A);
  const Eigen::MatrixXd F = symmetric_factor((1 - kHeldRadius * kHeldRadius) * M);
  fit.noise.setZero();
  fit.noise.leftCols(F.cols()) = F;
  return fit;
}

/// x̂(t+1) = A x̂(t) + K (x(t) − x̂(t)) as the state (x, x̂): both rows of A are (K, A − K), and the innovation
/// enters x. Its eigenvalues are A's and n zeros.
Fit innovations_fit(const Eigen::MatrixXd& V, const Innovations& found) {
  const Eigen::Index n = V.cols(), frames = V.rows(), used = frames - found.first;
  Fit fit{Eigen::MatrixXd(2 * n, 2 * n), Eigen::MatrixXd(2 * n, frames), {}};
  fit.A << found.K, found.A - found.K, found.K, found.A - found.K;
  fit.states << V.transpose(), found.forecasts;
  fit.noise = (V.transpose() - found.forecasts).rightCols(used) / std::sqrt(static_cast<double>(used));
  return fit;
}

/// Returns a number with at most 6 decimals.
std::string decimal_text(double value) {
  std::string text = core::fixed_text(value, 6);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

/// Fits by least squares where that is stable and leaves noise; else by its replacement.
Fit closed_form(const Eigen::MatrixXd& V, const LearnOptions& options, Dynamics& result) {
  Fit fit = least_squares_fit(V);
  if (options.method == Method::closed_form && is_undamped(fit))
    if (auto undamped = undamped_fit(fit)) {
      fit = *std::move(undamped);
      result.notes.emplace_back("the clip is waves without noise, which are kept undamped");
    }
  result.least_squares_radius = spectral_radius(fit.A);
  const bool stable = result.least_squares_radius < 1;
  result.noiseless = stable && is_noiseless(fit);
  if (stable && !result.noiseless) return fit;
  const std::string reason = stable ? "the least-squares fit leaves no noise to go on from"
                                    : "the least-squares fit is not stable (spectral radius " +
                                          decimal_text(result.least_squares_radius) + ")";
  result.transition = Transition::yule_walker;
  result.notes.push_back(reason + ": the Yule-Walker fit is taken");
  return yule_walker_fit(V);
}

/// Fits the innovations form; where none is found, the closed form is kept.
Fit innovations_form(const Eigen::MatrixXd& V, Fit closed, Dynamics& result) {
  const auto found = n4sid(V);
  if (!found) {
    result.notes.emplace_back(
        "the subspaces of the clip have no state of as many dimensions as there are "
        "components: the closed form is kept");
    return closed;
  }
  if (!found->note.empty()) result.notes.push_back(found->note);
  result.transition = Transition::n4sid;
  return innovations_fit(V, *found);
}

/// Returns F with F Fᵀ = noise noiseᵀ, or the strongest part of it in the requested number of inputs.
Eigen::MatrixXd driving_factor(const Eigen::MatrixXd& noise, const LearnOptions& options, Dynamics& result) {
  Eigen::MatrixXd B = left_factor(noise);
  const Eigen::Index rank = options.noise_rank;
  if (rank > B.cols())
    result.notes.push_back("what drives the clip has " + std::to_string(B.cols()) + " directions, " +
                           std::to_string(rank) + " were asked for: all are kept");
  if (rank == 0 || rank >= B.cols()) return B;
  result.noise_share = B.leftCols(rank).squaredNorm() / B.squaredNorm();
  return B.leftCols(rank);
}

void check_frames(const Eigen::MatrixXd& V, const LearnOptions& options) {
  const Eigen::Index n = V.cols(), frames = V.rows(), least = n4sid_frames(n);
  if (options.method == Method::n4sid && frames < least)
    throw core::InputError("method: n4sid of " + std::to_string(n) +
                           (n == 1 ? " component needs" : " components needs") + " at least " +
                           std::to_string(least) + " frames, the clip has " + std::to_string(frames));
}

}  // namespace

std::optional<std::string> variance_note(double drawn, double seen) {
  if (drawn <= kVarianceRatio * seen && seen <= kVarianceRatio * drawn) return std::nullopt;
  return "clips drawn from the model have " + core::significant_text(drawn / seen, 2) +
         " times the variance of the clip it was learned from";
}

Eigen::VectorXd variance_within(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, Eigen::Index frames) {
  const Eigen::MatrixXd P = stationary_covariance(A, B);
  // sum = I + A + … + A^(f−1) and weighted = Σ (f − j) A^j for f = 0, doubled and continued up to `frames`.
  const Eigen::Index n = A.rows();
  Eigen::MatrixXd power = Eigen::MatrixXd::Identity(n, n), sum = Eigen::MatrixXd::Zero(n, n), weighted = sum;
  Eigen::Index f = 0, bit = 1;
  while (bit <= frames / 2) bit *= 2;
  for (; bit > 0; bit /= 2) {
    weighted += static_cast<double>(f) * sum + power * weighted;
    sum += (power * sum).eval();
    power = (power * power).eval();
    f *= 2;
    if ((frames & bit) == 0) continue;
    sum += power;
    weighted += sum;
    power = (power * A).eval();
    ++f;
  }
  const auto t = static_cast<double>(frames);
  // The covariance of a clip's mean is Σ over its pairs of frames.
  return P.diagonal() - (2 * (weighted * P).diagonal() - t * P.diagonal()) / (t * t);
}

Dynamics fit_dynamics(const UnitStates& states, const LearnOptions& options) {
  const auto& [s, V] = states;
  const Eigen::Index n = V.cols();
  Dynamics result;
  if (n == 0) {
    result.A = result.B = Eigen::MatrixXd(0, 0);
    result.states.resize(0, V.rows());
    return result;
  }
  check_frames(V, options);
  Fit fit = closed_form(V, options, result);
  if (options.method == Method::n4sid && !result.noiseless) fit = innovations_form(V, std::move(fit), result);
  const Eigen::Index order = fit.A.rows();
  const Eigen::VectorXd scale = s.replicate(order / n, 1);
  result.A = scale.asDiagonal() * fit.A * scale.cwiseInverse().asDiagonal();
  result.states = scale.asDiagonal() * fit.states;
  const Eigen::MatrixXd B = driving_factor(s.asDiagonal() * fit.noise, options, result);
  result.B = Eigen::MatrixXd::Zero(order, B.cols());
  result.B.topRows(n) = B;
  return result;
}

}  // namespace emberfold::dytex::detail
