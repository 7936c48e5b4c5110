// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace emberfold::dytex::detail {

/// Poles that are treated as one, since no well-conditioned basis separates them.
struct PoleBlock {
  Eigen::Index first = 0, size = 0;                     ///< rows of PoleBlocks::diagonal
  int pairs = 0, positive = 0, negative = 0, zero = 0;  ///< how many of each: size = 2 pairs + the others
  double phase = 0;                                     ///< mean of the pairs', 0 … π
};

/// A = basis · diagonal · inverse, `diagonal` block-diagonal.
struct PoleBlocks {
  Eigen::MatrixXd basis, inverse, diagonal;
  std::vector<PoleBlock> blocks;
};

/// Block-diagonalises a square matrix from its real Schur form (Bavely, Stewart 1979): a real pole or a pair
/// is split off unless the transformation that does so has a norm above 10⁴; then it is joined by the nearest
/// pole within 0.1, and so on. NumericalError where the Schur form is not found. O(n³) where no poles are
/// close.
PoleBlocks pole_blocks(const Eigen::MatrixXd& matrix);

}  // namespace emberfold::dytex::detail
