// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/error.hpp"
#include "dytex/distances/distances.hpp"
#include "dytex/distances/pair_gram.hpp"
#include "dytex/learning/decompositions.hpp"

// KL(p ‖ q) frame by frame: the filter of q runs over frames of p. With x̂ the state that it predicts,
//   z = [x_p; x̂_q; 1],   e = y − ŷ_q = H z + w,   H = [C_p, −C_q, mean_p − mean_q],
// z is itself a linear process, and a frame's divergence needs only E[z zᵀ] and products of H's columns:
//   ½ (log |S_q| − log |S_p| − m + tr S_q⁻¹ E[e eᵀ]),   S⁻¹ = R⁻¹ − R⁻¹ C Σ Cᵀ R⁻¹,   Σ = (P⁻¹ + CᵀR⁻¹C)⁻¹.
namespace emberfold::dytex {

namespace {

constexpr int kMostDoublings = 64;           // 2^64 frames
constexpr double kRelativeRounding = 1e-13;  // of a sum's terms; a divergence below it is 0
constexpr int kMostFrames = 100'000;         // of kl_growth()

struct Process {
  Eigen::MatrixXd A, Q;
  Eigen::MatrixXd K;  // CᵀR⁻¹C
};

struct Pair {
  Process p, q;
  Eigen::MatrixXd products;  // HᵀR_q⁻¹H
  Eigen::MatrixXd noise;     // C_qᵀ R_q⁻¹ R_p R_q⁻¹ C_q
  double noises = 0;         // Σ ρ − 1 − log ρ over the frame's values, ρ = R_p / R_q
};

void check_noise(const LinearDynamicTexture& texture, const char* which) {
  if (!has_noise(texture))
    throw core::InputError(std::string("the noise r of the ") + which +
                           " model is 0, so the KL rate is infinite; learn it with fewer components than the "
                           "clip has independent frames, so that r is estimated");
}

/// Returns log |I + K P|; (I + P K)⁻¹ P is the covariance P after a frame is observed.
double log_det(const Eigen::MatrixXd& K, const Eigen::MatrixXd& P) {
  if (K.size() == 0) return 0;
  const Eigen::MatrixXd sum = Eigen::MatrixXd::Identity(K.rows(), K.rows()) + K * P;
  return detail::LuFactors(sum).log_determinant();
}

Eigen::MatrixXd updated(const Eigen::MatrixXd& K, const Eigen::MatrixXd& P) {
  if (K.size() == 0) return P;
  const Eigen::MatrixXd sum = Eigen::MatrixXd::Identity(K.rows(), K.rows()) + P * K;
  const Eigen::MatrixXd left = detail::LuFactors(sum).solve(P);
  return (left + left.transpose()) / 2;
}

/// Returns P = A (P⁻¹ + K)⁻¹ Aᵀ + Q, the steady error covariance of the predicted state, by doubling.
Eigen::MatrixXd steady_covariance(const Process& process) {
  const Eigen::Index n = process.A.rows();
  Eigen::MatrixXd A = process.A.transpose(), G = process.K, P = process.Q;
  for (int step = 0; step < kMostDoublings && n > 0; ++step) {
    const detail::LuFactors lu(Eigen::MatrixXd::Identity(n, n) + G * P);
    const Eigen::MatrixXd solved_A = lu.solve(A), solved_G = lu.solve(G);
    const Eigen::MatrixXd more = A.transpose() * P * solved_A;
    G += A * solved_G * A.transpose();
    P += (more + more.transpose()) / 2;
    G = ((G + G.transpose()) / 2).eval();
    A = (A * solved_A).eval();
    if (!P.allFinite()) break;
    if (more.norm() <= std::numeric_limits<double>::epsilon() * P.norm()) return P;
  }
  if (n == 0) return P;
  throw core::NumericalError("the covariance of a model's predictions did not settle");
}

Eigen::VectorXd variances(const LinearDynamicTexture& texture) {
  if (texture.noise.size() > 0) return texture.noise.cast<double>();
  return Eigen::VectorXd::Constant(texture.pixels(), texture.r);
}

/// Does what make_pair() does, where noise differs from value to value.
void weigh_by_value(const LinearDynamicTexture& p, const LinearDynamicTexture& q, Pair& pair) {
  const Eigen::VectorXd R_p = variances(p), R_q = variances(q), ratios = R_p.cwiseQuotient(R_q);
  const auto by_p = detail::pair_gram(p, q, R_p.cwiseInverse());
  const auto by_q = detail::pair_gram(p, q, R_q.cwiseInverse());
  const auto by_both = detail::pair_gram(p, q, ratios.cwiseQuotient(R_q));
  pair.p.K = block_pp(by_p);
  pair.q.K = block_qq(by_q);
  pair.products = by_q.products;
  pair.noise = block_qq(by_both);
  pair.noises = (ratios.array() - 1 - ratios.array().log()).sum();
}

Pair make_pair(const LinearDynamicTexture& p, const LinearDynamicTexture& q, const detail::PairGram& gram) {
  check_noise(p, "first");
  check_noise(q, "second");
  Pair pair{{p.A, p.B * p.B.transpose(), {}}, {q.A, q.B * q.B.transpose(), {}}, {}, {}, 0};
  if (p.noise.size() == 0 && q.noise.size() == 0) {
    const double ratio = p.r / q.r;
    pair.p.K = block_pp(gram) / p.r;
    pair.q.K = block_qq(gram) / q.r;
    pair.products = gram.products / q.r;
    pair.noise = pair.q.K * ratio;
    pair.noises = static_cast<double>(p.pixels()) * (ratio - 1 - std::log(ratio));
  } else {
    weigh_by_value(p, q, pair);
  }
  pair.products.middleRows(gram.p, gram.q) *= -1;  // H shows −C_q
  pair.products.middleCols(gram.p, gram.q) *= -1;
  return pair;
}

/// z(t+1) = F z(t) + noise of covariance W.
struct Step {
  Eigen::MatrixXd F, W;
};

Step step_of(const Pair& pair, const Eigen::MatrixXd& left) {
  const Eigen::Index p = pair.p.A.rows(), q = pair.q.A.rows(), size = p + q + 1;
  const Eigen::MatrixXd gain = pair.q.A * left;
  Step step{Eigen::MatrixXd::Zero(size, size), Eigen::MatrixXd::Zero(size, size)};
  step.F.topLeftCorner(p, p) = pair.p.A;
  step.F.middleRows(p, q) = -gain * pair.products.middleRows(p, q);
  step.F.block(p, p, q, q) += pair.q.A;
  step.F(size - 1, size - 1) = 1;
  step.W.topLeftCorner(p, p) = pair.p.Q;
  step.W.block(p, p, q, q) = gain * pair.noise * gain.transpose();
  return step;
}

/// Returns the divergence of one frame given those before; 0 where it is not above the rounding of its terms.
double frame_divergence(const Pair& pair, const Eigen::MatrixXd& P_p, const Eigen::MatrixXd& P_q,
                        const Eigen::MatrixXd& left, const Eigen::MatrixXd& moments) {
  const Eigen::Index p = pair.p.A.rows(), q = pair.q.A.rows();
  const auto rows = pair.products.middleRows(p, q);
  const double all = (pair.products * moments).trace();
  const double explained = (left * (rows * moments * rows.transpose() + pair.noise)).trace();
  const double log_p = log_det(pair.p.K, P_p), log_q = log_det(pair.q.K, P_q);
  const double value = (pair.noises + all - explained + log_q - log_p) / 2;
  const double size = pair.noises + std::abs(all) + std::abs(explained) + std::abs(log_p) + std::abs(log_q);
  return value > kRelativeRounding * size ? value : 0;
}

}  // namespace

bool has_noise(const LinearDynamicTexture& texture) {
  return texture.noise.size() > 0 ? texture.noise.minCoeff() > 0 : texture.r > 0;
}

double kl_rate(const LinearDynamicTexture& p, const LinearDynamicTexture& q) {
  return detail::kl_rate(p, q, detail::pair_gram(p, q));
}

double detail::kl_rate(const LinearDynamicTexture& p, const LinearDynamicTexture& q, const PairGram& gram) {
  const Pair pair = make_pair(p, q, gram);
  const Eigen::MatrixXd P_p = steady_covariance(pair.p), P_q = steady_covariance(pair.q);
  const Eigen::MatrixXd left = updated(pair.q.K, P_q);
  const Step step = step_of(pair, left);
  const Eigen::Index states = step.F.rows() - 1;
  // The last of z is the constant 1, whose eigenvalue 1 makes sums over all frames diverge.
  Eigen::MatrixXd moments = Eigen::MatrixXd::Constant(1, 1, 1);
  if (states > 0) {
    const Eigen::MatrixXd F = step.F.topLeftCorner(states, states);
    const Eigen::VectorXd mean = detail::LuFactors(Eigen::MatrixXd::Identity(states, states) - F)
                                     .solve_vector(step.F.col(states).head(states));
    moments.resize(states + 1, states + 1);
    moments.topLeftCorner(states, states) =
        detail::doubled_sum(F, F.transpose(), step.W.topLeftCorner(states, states)) + mean * mean.transpose();
    moments.col(states) << mean, 1;
    moments.row(states) << mean.transpose(), 1;
  }
  return frame_divergence(pair, P_p, P_q, left, moments);
}

Eigen::VectorXd kl_growth(const LinearDynamicTexture& p, const LinearDynamicTexture& q, int length,
                          const core::Context& context) {
  if (length < 1 || length > kMostFrames)
    throw core::InputError("length is " + std::to_string(length) + "; allowed is 1 to " +
                           std::to_string(kMostFrames));
  const Pair pair = make_pair(p, q, detail::pair_gram(p, q));
  Eigen::MatrixXd P_p = stationary_covariance(p.A, p.B), P_q = stationary_covariance(q.A, q.B);
  const Eigen::Index size = pair.products.rows();
  Eigen::MatrixXd moments = Eigen::MatrixXd::Zero(size, size);
  moments.topLeftCorner(P_p.rows(), P_p.rows()) = P_p;
  moments(size - 1, size - 1) = 1;
  Eigen::VectorXd sum(length);
  double total = 0;
  for (int t = 0; t < length; ++t) {
    context.check();
    context.report("growth", static_cast<double>(t) / length);
    const Eigen::MatrixXd left_p = updated(pair.p.K, P_p), left_q = updated(pair.q.K, P_q);
    total += frame_divergence(pair, P_p, P_q, left_q, moments);
    sum[t] = total;
    const Step step = step_of(pair, left_q);
    moments = (step.F * moments * step.F.transpose() + step.W).eval();
    P_p = pair.p.A * left_p * pair.p.A.transpose() + pair.p.Q;
    P_q = pair.q.A * left_q * pair.q.A.transpose() + pair.q.Q;
  }
  return sum;
}

}  // namespace emberfold::dytex
