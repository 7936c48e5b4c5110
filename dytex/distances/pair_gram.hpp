// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::dytex::detail {

/// Gram matrix of two textures together: of [C_p 0, C_q 0, mean_p − mean_q], C weighted as frames show it, a
/// column for each number of the states and one for the means.
struct PairGram {
  Eigen::Index p = 0, q = 0;  ///< orders of the two
  Eigen::MatrixXd products;   ///< (p + q + 1)²

  /// Returns the Gram matrix of the pair (q, p).
  [[nodiscard]] PairGram swapped() const;
};
inline auto block_pp(const PairGram& pair) {
  return pair.products.topLeftCorner(pair.p, pair.p);
}
inline auto block_pq(const PairGram& pair) {
  return pair.products.block(0, pair.p, pair.p, pair.q);
}
inline auto block_qq(const PairGram& pair) {
  return pair.products.block(pair.p, pair.p, pair.q, pair.q);
}

/// Throws InputError unless both have frames of the same size and channels.
void check_pair(const LinearDynamicTexture& p, const LinearDynamicTexture& q);

/// Computes the Gram matrix over a frame's values, each with its factor ≥ 0 (1 where `factors` is empty).
/// In double, in a fixed order at any thread count. O(m (n_p + n_q)²).
PairGram pair_gram(const LinearDynamicTexture& p, const LinearDynamicTexture& q,
                   const Eigen::VectorXd& factors = {});

/// Returns dytex::kl_rate() from a Gram matrix without factors.
double kl_rate(const LinearDynamicTexture& p, const LinearDynamicTexture& q, const PairGram& gram);

/// Solves X = F X G + W by doubling. NumericalError where it does not converge.
Eigen::MatrixXd doubled_sum(Eigen::MatrixXd F, Eigen::MatrixXd G, Eigen::MatrixXd W);

}  // namespace emberfold::dytex::detail
