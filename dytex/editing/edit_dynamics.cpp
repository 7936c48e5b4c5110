// SPDX-License-Identifier: Apache-2.0
#include "dytex/editing/edit_dynamics.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "dytex/editing/pole_blocks.hpp"
#include "dytex/learning/decompositions.hpp"
#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr double kRest = 0x1p-40;             // of a state is lost in a frame at rest: still stable
constexpr double kLeastVariance = 1e-12;      // of the largest; directions below it do not move
constexpr double kNegativeRounding = 1e-13;   // of a matrix's size; smaller eigenvalues are rounding
constexpr double kPhaseRounding = 1e-12;      // of pi; a phase this little above it has not passed it
constexpr double kLargestRadius = 1 - 1e-12;  // to which a radius that rounding made 1 is reduced
constexpr int kMostNewtonSteps = 60;          // bounds the time; convergence is quadratic
constexpr double kNewtonTolerance = 1e-15;    // relative change

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// States measured in their own standard deviations, x = L z: A's norm there is at most 1, so that scale in
/// levels does not count when poles are separated.
struct Whitening {
  MatrixXd L, inverse;
  [[nodiscard]] MatrixXd white(const MatrixXd& A) const { return inverse * A * L; }
};

Whitening whitening(const MatrixXd& covariance) {
  const SymmetricEigen eigen = symmetric_eigen(covariance);
  const double largest = eigen.values[0];
  if (!(largest > 0))
    return {MatrixXd::Identity(covariance.rows(), covariance.rows()),
            MatrixXd::Identity(covariance.rows(), covariance.rows())};
  const VectorXd scale = eigen.values.cwiseMax(kLeastVariance * largest).cwiseSqrt();
  return {eigen.vectors * scale.asDiagonal(), scale.cwiseInverse().asDiagonal() * eigen.vectors.transpose()};
}

/// F with F Fᵀ = the symmetric matrix without its negative part, and the share of that part.
struct Factor {
  MatrixXd F;
  double cut = 0;
};

Factor positive_factor(const MatrixXd& symmetric, double size) {
  const SymmetricEigen eigen = symmetric_eigen((symmetric + symmetric.transpose()) / 2);
  const Index kept = (eigen.values.array() > kNegativeRounding * size).count();
  const double positive = eigen.values.head(kept).sum();
  const double negative = -(eigen.values.array() < -kNegativeRounding * size).select(eigen.values, 0).sum();
  return {eigen.vectors.leftCols(kept) * eigen.values.head(kept).cwiseSqrt().asDiagonal(),
          negative > 0 ? negative / (positive + negative) : 0};
}

/// Returns J with J² = −I that commutes with the block, its eigenvalues +i for the upper poles: Newton's
/// iteration for the matrix sign. A single pair takes one division.
MatrixXd quarter_turn(const MatrixXd& block) {
  MatrixXd J = block - block.trace() / static_cast<double>(block.rows()) *
                           MatrixXd::Identity(block.rows(), block.rows());
  if (block.rows() == 2) return J / std::sqrt(determinant(J));
  for (int step = 0; step < kMostNewtonSteps; ++step) {
    const MatrixXd next = (J - inverse(J)) / 2;
    const double change = (next - J).norm();
    J = next;
    if (!(change > kNewtonTolerance * J.norm())) break;
  }
  return J;
}

/// Splits A into its blocks, in a basis of states in levels.
PoleBlocks blocks_of(const MatrixXd& A, const MatrixXd& covariance) {
  const Whitening whitening = detail::whitening(covariance);
  PoleBlocks poles = pole_blocks(whitening.white(A));
  poles.basis = whitening.L * poles.basis;
  poles.inverse = poles.inverse * whitening.inverse;
  return poles;
}

using BlockChange = std::function<MatrixXd(const PoleBlock&, const MatrixXd&)>;

/// Returns basis · diagonal · inverse after `change` was applied to each block of the diagonal.
MatrixXd assembled(const MatrixXd& basis, MatrixXd diagonal, const MatrixXd& inverse,
                   const std::vector<PoleBlock>& blocks, EditedDynamics& result, const BlockChange& change) {
  for (const PoleBlock& block : blocks) {
    auto part = diagonal.block(block.first, block.first, block.size, block.size);
    part = change(block, MatrixXd(part));
    if (!is_alone(block) && block.zero < block.size) result.together += static_cast<int>(block.size);
  }
  MatrixXd changed = basis * diagonal * inverse;
  // Poles keep their moduli, or get smaller: only rounding can bring the largest to 1.
  if (const double radius = spectral_radius(changed); !(radius < 1)) changed *= kLargestRadius / radius;
  return changed;
}

MatrixXd zero(const PoleBlock& block, EditedDynamics& result) {
  result.dropped += static_cast<int>(block.size);
  return MatrixXd::Zero(block.size, block.size);
}

MatrixXd power_of_block(const PoleBlock& block, const MatrixXd& T, double factor, EditedDynamics& result) {
  if (block.zero == block.size) return MatrixXd::Zero(block.size, block.size);
  if (block.zero > 0 || (block.positive > 0 && block.negative > 0)) return zero(block, result);
  if (block.pairs > 0 && factor * block.phase > std::numbers::pi) result.wrapped += 2 * block.pairs;
  if (block.size == 1)
    return MatrixXd::Constant(1, 1, std::copysign(std::pow(std::abs(T(0, 0)), factor), T(0, 0)));
  if (block.size == 2 && block.pairs == 1) {
    const double modulus = std::pow(determinant(T), factor / 2), phase = factor * block.phase;
    return modulus * (std::cos(phase) * MatrixXd::Identity(2, 2) + std::sin(phase) * quarter_turn(T));
  }
  return block.negative > 0 ? MatrixXd(-matrix_power(-T, factor)) : matrix_power(T, factor);
}

}  // namespace

MatrixXd aligned_factor(const MatrixXd& F, const MatrixXd& like) {
  const Index n = F.rows(), p = F.cols(), k = like.cols();
  MatrixXd result = MatrixXd::Zero(n, std::max(p, k));
  if (p == 0) return result;
  const auto [U, V] = singular_vectors(F.transpose() * like);  // the orthogonal Procrustes problem
  result.leftCols(k) = F * U.leftCols(V.cols()) * V.transpose();
  if (p > k) result.rightCols(p - k) = F * U.rightCols(p - k);
  return result;
}

bool turns(const PoleBlock& block) {
  return block.pairs > 0 && 2 * block.pairs >= block.size;
}

bool is_alone(const PoleBlock& block) {
  return block.size == 1 || (block.size == 2 && block.pairs == 1);
}

bool passes_half_turn(const PoleBlock& block, double factor) {
  return std::abs(factor) * block.phase > std::numbers::pi * (1 + kPhaseRounding);
}

SpeedForm speed_form(const MatrixXd& A, const MatrixXd& covariance) {
  PoleBlocks poles = blocks_of(A, covariance);
  SpeedForm form{std::move(poles.basis), std::move(poles.inverse), std::move(poles.diagonal),
                 MatrixXd::Zero(A.rows(), A.cols()), std::move(poles.blocks)};
  for (const PoleBlock& block : form.blocks)
    if (turns(block))
      form.quarter_turn.block(block.first, block.first, block.size, block.size) =
          quarter_turn(form.diagonal.block(block.first, block.first, block.size, block.size));
  return form;
}

EditedDynamics at_speed(const MatrixXd& A, const MatrixXd& B, double factor) {
  EditedDynamics result{A, B};
  const SpeedForm form = speed_form(A, stationary_covariance(A, B));
  result.A = assembled(form.basis, form.diagonal, form.inverse, form.blocks, result,
                       [&](const PoleBlock& block, const MatrixXd& T) {
                         if (!turns(block)) return T;
                         if (passes_half_turn(block, factor)) return zero(block, result);
                         const double turn = (factor - 1) * block.phase;
                         const MatrixXd J =
                             form.quarter_turn.block(block.first, block.first, block.size, block.size);
                         return MatrixXd(std::cos(turn) * T + std::sin(turn) * T * J);
                       });
  return result;
}

EditedDynamics at_flow(const MatrixXd& A, const MatrixXd& B, double factor) {
  EditedDynamics result{A, B};
  const MatrixXd P = stationary_covariance(A, B);
  const PoleBlocks poles = blocks_of(A, P);
  result.A = assembled(
      poles.basis, poles.diagonal, poles.inverse, poles.blocks, result,
      [&](const PoleBlock& block, const MatrixXd& T) { return power_of_block(block, T, factor, result); });
  const Whitening whitening = detail::whitening(P);
  const MatrixXd left = whitening.inverse * result.A;
  const MatrixXd white = whitening.inverse * P * whitening.inverse.transpose();
  const Factor factored = positive_factor(white - left * P * left.transpose(), white.norm());
  result.cut = factored.cut;
  result.B = aligned_factor(whitening.L * factored.F, B);
  return result;
}

EditedDynamics at_rest(const MatrixXd& A, const MatrixXd& B) {
  const MatrixXd P = stationary_covariance(A, B);
  const double left = 1 - kRest;
  const double noise = std::sqrt(1 - left * left);
  return {left * MatrixXd::Identity(A.rows(), A.cols()), aligned_factor(noise * detail::whitening(P).L, B)};
}

EditedDynamics reverse_dynamics(const MatrixXd& A, const MatrixXd& B) {
  EditedDynamics result{A, B};
  const MatrixXd P = stationary_covariance(A, B);
  const SymmetricEigen eigen = symmetric_eigen(P);
  const Index rank = (eigen.values.array() > kLeastVariance * eigen.values[0]).count();
  if (rank == 0) return result;  // nothing moves
  // In white states z, x = L z, the covariance is I and A' = Aᵀ.
  const VectorXd scale = eigen.values.head(rank).cwiseSqrt();
  const MatrixXd L = eigen.vectors.leftCols(rank) * scale.asDiagonal();
  const MatrixXd inverse = scale.cwiseInverse().asDiagonal() * eigen.vectors.leftCols(rank).transpose();
  const MatrixXd white = inverse * A * L;
  result.A = L * white.transpose() * inverse;
  const MatrixXd noise = MatrixXd::Identity(rank, rank) - white.transpose() * white;
  result.B = aligned_factor(L * positive_factor(noise, 1).F, B);
  if (const double radius = spectral_radius(result.A); !(radius < 1)) result.A *= kLargestRadius / radius;
  return result;
}

}  // namespace emberfold::dytex::detail
