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

/// One block's fit, in states of unit size: A and `states` of the whole state, layer by layer; errors of its
/// first layer, the only one that noise enters.
struct Fit {
  Eigen::MatrixXd A, states;
  Eigen::MatrixXd noise;  ///< F with F Fᵀ the noise's covariance
};

/// (v(t), …, v(t + 1 − lags)) for t from `first` to `last`, a row each; 0 outside the clip.
Eigen::MatrixXd lagged_rows(const Eigen::MatrixXd& V, Eigen::Index lags, Eigen::Index first,
                            Eigen::Index last) {
  const Eigen::Index n = V.cols();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(last - first + 1, n * lags);
  for (Eigen::Index k = 0; k < lags; ++k) {
    const Eigen::Index from = std::max<Eigen::Index>(first - k, 0),
                       to = std::min<Eigen::Index>(last - k, V.rows() - 1);
    if (from <= to) rows.block(from + k - first, k * n, to - from + 1, n) = V.middleRows(from, to - from + 1);
  }
  return rows;
}

/// Returns the companion form of x(t+1) = (A₁ … A_lags) (x(t), …): each layer becomes the next one's.
Eigen::MatrixXd companion(const Eigen::MatrixXd& first) {
  const Eigen::Index n = first.rows(), order = first.cols();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(order, order);
  A.topRows(n) = first;
  A.bottomLeftCorner(order - n, order - n).setIdentity();
  return A;
}

/// The states of all frames; those before the clip are assumed to be its first frame.
Eigen::MatrixXd all_states(const Eigen::MatrixXd& V, Eigen::Index lags) {
  Eigen::MatrixXd longer(V.rows() + lags - 1, V.cols());
  longer.topRows(lags - 1) = V.row(0).replicate(lags - 1, 1);
  longer.bottomRows(V.rows()) = V;
  return lagged_rows(longer, lags, lags - 1, longer.rows() - 1).transpose();
}

Fit regression_of(const Eigen::MatrixXd& V, Eigen::Index lags, const Eigen::MatrixXd& first) {
  const Eigen::Index frames = V.rows();
  Fit fit{companion(first), all_states(V, lags), {}};
  fit.noise = (V.bottomRows(frames - lags).transpose() -
               first * lagged_rows(V, lags, lags - 1, frames - 2).transpose()) /
              std::sqrt(static_cast<double>(frames - lags));
  return fit;
}

Fit least_squares_fit(const Eigen::MatrixXd& V, Eigen::Index lags) {
  const Eigen::Index frames = V.rows();
  return regression_of(
      V, lags,
      least_squares(lagged_rows(V, lags, lags - 1, frames - 2), V.bottomRows(frames - lags)).transpose());
}

/// Fits with zeros before and after the clip: always stable, and F Fᵀ = P − A P Aᵀ, P the data's covariance.
Fit yule_walker_fit(const Eigen::MatrixXd& V, Eigen::Index lags) {
  const Eigen::Index n = V.cols(), frames = V.rows(), rows = frames + lags;
  const Eigen::MatrixXd past = lagged_rows(V, lags, -1, frames + lags - 2);
  Eigen::MatrixXd next = Eigen::MatrixXd::Zero(rows, n);
  next.topRows(frames) = V;
  // With one lag the states' covariance is the identity.
  const Eigen::MatrixXd first =
      lags == 1 ? Eigen::MatrixXd(next.transpose() * past) : least_squares(past, next).transpose();
  Fit fit = regression_of(V, lags, first);
  fit.noise = (next.transpose() - first * past.transpose()) / std::sqrt(static_cast<double>(frames));
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

/// Fits by least squares where all blocks have a stable fit that leaves noise; else by its replacement.
std::vector<Fit> closed_form(const std::vector<Block>& blocks, const LearnOptions& options,
                             Dynamics& result) {
  std::vector<Fit> fits;
  for (const Block& block : blocks) {
    fits.push_back(least_squares_fit(block.V, options.lags));
    if (options.method == Method::closed_form && is_undamped(fits.back()))
      if (auto undamped = undamped_fit(fits.back())) {
        fits.back() = *std::move(undamped);
        result.notes.emplace_back("the clip is waves without noise, which are kept undamped");
      }
    const double radius = spectral_radius(fits.back().A);
    result.least_squares_radius = std::max(result.least_squares_radius, radius);
    if (radius < 1 && is_noiseless(fits.back())) result.noiseless = true;
  }
  const bool stable = result.least_squares_radius < 1;
  if (stable && !result.noiseless) return fits;
  const std::string reason = stable ? "the least-squares fit leaves no noise to go on from"
                                    : "the least-squares fit is not stable (spectral radius " +
                                          decimal_text(result.least_squares_radius) + ")";
  result.transition = Transition::yule_walker;
  result.notes.push_back(reason + ": the Yule-Walker fit is taken");
  for (std::size_t i = 0; i < blocks.size(); ++i) fits[i] = yule_walker_fit(blocks[i].V, options.lags);
  return fits;
}

/// Fits the innovations forms; where one is not found, the closed form is kept.
std::vector<Fit> innovations_forms(const std::vector<Block>& blocks, std::vector<Fit> fits,
                                   Dynamics& result) {
  std::vector<Fit> better;
  for (const Block& block : blocks) {
    const auto found = n4sid(block.V);
    if (!found) {
      result.notes.emplace_back(
          "the subspaces of the clip have no state of as many dimensions as there are "
          "components: the closed form is kept");
      return fits;
    }
    if (!found->note.empty()) result.notes.push_back(found->note);
    better.push_back(innovations_fit(block.V, *found));
  }
  result.transition = Transition::n4sid;
  return better;
}

/// A block's rows in the model: layer by layer, in each in the order of the components.
std::vector<Eigen::Index> rows_of(const Block& block, Eigen::Index n, Eigen::Index layers) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index layer = 0; layer < layers; ++layer)
    for (const Eigen::Index place : block.places) rows.push_back(layer * n + place);
  return rows;
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

void assemble(const std::vector<Block>& blocks, const std::vector<Fit>& fits, const LearnOptions& options,
              Dynamics& result) {
  Eigen::Index n = 0;
  for (const Block& block : blocks) n += block.V.cols();
  const Eigen::Index layers = fits[0].A.rows() / blocks[0].V.cols(), order = n * layers;
  result.A = Eigen::MatrixXd::Zero(order, order);
  result.states.resize(order, fits[0].states.cols());
  Eigen::MatrixXd noise(n, fits[0].noise.cols());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const Eigen::VectorXd& s = blocks[i].s;
    const Eigen::VectorXd scale = s.replicate(layers, 1);
    const auto rows = rows_of(blocks[i], n, layers);
    result.A(rows, rows) = scale.asDiagonal() * fits[i].A * scale.cwiseInverse().asDiagonal();
    result.states(rows, Eigen::all) = scale.asDiagonal() * fits[i].states;
    noise(blocks[i].places, Eigen::all) = s.asDiagonal() * fits[i].noise;
  }
  const Eigen::MatrixXd B = driving_factor(noise, options, result);
  result.B = Eigen::MatrixXd::Zero(order, B.cols());
  result.B.topRows(n) = B;
}

void check_frames(const std::vector<Block>& blocks, const LearnOptions& options) {
  for (const Block& block : blocks) {
    const Eigen::Index n = block.V.cols(), frames = block.V.rows();
    const auto need = [&](Eigen::Index least, const std::string& what) {
      if (frames < least)
        throw core::InputError(what + " of " + std::to_string(n) +
                               (n == 1 ? " component needs" : " components needs") + " at least " +
                               std::to_string(least) + " frames, the clip has " + std::to_string(frames));
    };
    if (options.lags > 1) need(n * options.lags + 2, "lags: an auto-regression");
    if (options.method == Method::n4sid) need(n4sid_frames(n), "method: n4sid");
  }
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

Dynamics fit_dynamics(const std::vector<Block>& all, const LearnOptions& options) {
  Dynamics result;
  std::vector<Block> blocks;
  for (const Block& block : all)
    if (block.V.cols() > 0) blocks.push_back(block);
  if (blocks.empty()) {
    result.A = result.B = Eigen::MatrixXd(0, 0);
    result.states.resize(0, all.empty() ? 0 : all[0].V.rows());
    return result;
  }
  check_frames(blocks, options);
  std::vector<Fit> fits = closed_form(blocks, options, result);
  if (options.method == Method::n4sid && !result.noiseless)
    fits = innovations_forms(blocks, std::move(fits), result);
  assemble(blocks, fits, options, result);
  return result;
}

}  // namespace emberfold::dytex::detail
