// SPDX-License-Identifier: Apache-2.0
#include "dytex/editing/pole_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "dytex/learning/decompositions.hpp"

namespace emberfold::dytex::detail {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

constexpr double kMostNorm = 1e4;      // of a transformation that splits a block off: 4 of 16 digits are lost
constexpr double kJoinDistance = 0.1;  // between poles; those farther apart are never joined
constexpr double kZeroModulus = 1e-9;  // a pole below this is 0
constexpr double kSwapError = 100 * std::numeric_limits<double>::epsilon();  // of a swapped block, relative

/// A Schur form that is being made block-diagonal.
struct Schur {
  MatrixXd T, basis, inverse;
  [[nodiscard]] Index size() const { return T.rows(); }
  /// Rows of the diagonal block that begins at `first`: 1 or 2.
  [[nodiscard]] Index width(Index first) const {
    return first + 1 < size() && T(first + 1, first) != 0 ? 2 : 1;
  }
};

/// Both eigenvalues of a 2 × 2 block.
std::pair<Complex, Complex> eigenvalues(const Eigen::Matrix2d& block) {
  const double half = (block(0, 0) - block(1, 1)) / 2;
  const Complex root = std::sqrt(Complex(half * half + block(0, 1) * block(1, 0)));
  const double mean = (block(0, 0) + block(1, 1)) / 2;
  return {mean + root, mean - root};
}

/// A pole of the block that begins at `first`, of a pair the upper one.
Complex pole(const Schur& schur, Index first) {
  if (schur.width(first) == 1) return schur.T(first, first);
  return eigenvalues(schur.T.block<2, 2>(first, first)).first;
}

/// Solves P X − X Q = R for X; huge or not finite where P and Q nearly share an eigenvalue.
MatrixXd solve_sylvester(const MatrixXd& P, const MatrixXd& Q, const MatrixXd& R) {
  const Index p = P.rows(), q = Q.rows();
  MatrixXd system = MatrixXd::Zero(p * q, p * q);
  for (Index j = 0; j < q; ++j) {
    system.block(j * p, j * p, p, p) = P;
    for (Index i = 0; i < q; ++i) system.block(j * p, i * p, p, p).diagonal().array() -= Q(i, j);
  }
  return LuFactors(system).solve_vector(R.reshaped()).reshaped(p, q);
}

/// Swaps the diagonal blocks at `first` (p rows) and after it (q rows) by an orthogonal transformation (Bai,
/// Demmel 1993). Returns false, and changes nothing, where they are too close for that.
bool swap_blocks(Schur& schur, Index first, Index p, Index q) {
  MatrixXd& T = schur.T;
  const MatrixXd X = solve_sylvester(T.block(first, first, p, p), T.block(first + p, first + p, q, q),
                                     T.block(first, first + p, p, q));
  if (!X.allFinite()) return false;
  MatrixXd invariant(p + q, q);
  invariant << -X, MatrixXd::Identity(q, q);
  const MatrixXd turn = full_q(invariant);
  const MatrixXd swapped = turn.transpose() * T.block(first, first, p + q, p + q) * turn;
  if (swapped.bottomLeftCorner(p, q).norm() > kSwapError * T.norm()) return false;
  T.middleRows(first, p + q) = (turn.transpose() * T.middleRows(first, p + q)).eval();
  T.middleCols(first, p + q) = (T.middleCols(first, p + q) * turn).eval();
  T.block(first + q, first, p, q).setZero();
  schur.basis.middleCols(first, p + q) = (schur.basis.middleCols(first, p + q) * turn).eval();
  schur.inverse.middleRows(first, p + q) = (turn.transpose() * schur.inverse.middleRows(first, p + q)).eval();
  return true;
}

/// Returns X that splits rows first … first + size off from those after them: P X − X R = −T_PR, column block
/// by column block.
MatrixXd splitting(const Schur& schur, Index first, Index size) {
  const Index begin = first + size, rest = schur.size() - begin;
  const MatrixXd P = schur.T.block(first, first, size, size);
  MatrixXd X = MatrixXd::Zero(size, rest);
  for (Index j = 0, width = 1; j < rest; j += width) {
    width = schur.width(begin + j);
    const MatrixXd known = X.leftCols(j) * schur.T.block(begin, begin + j, j, width) -
                           schur.T.block(first, begin + j, size, width);
    X.middleCols(j, width) = solve_sylvester(P, schur.T.block(begin + j, begin + j, width, width), known);
  }
  return X;
}

/// Joins the nearest pole to the block, if one is near, and returns the block's new size.
Index join_nearest(Schur& schur, Index first, Index size) {
  Index nearest = -1;
  double least = kJoinDistance;
  for (Index i = first; i < first + size; i += schur.width(i))
    for (Index j = first + size; j < schur.size(); j += schur.width(j))
      if (const double distance = std::abs(pole(schur, i) - pole(schur, j)); distance < least) {
        least = distance;
        nearest = j;
      }
  if (nearest < 0) return size;
  const Index width = schur.width(nearest);
  for (Index at = nearest; at > first + size;) {
    const Index before = at - (at - 2 >= first + size && schur.width(at - 2) == 2 ? 2 : 1);
    if (!swap_blocks(schur, before, at - before, width)) return at + width - first;  // those between join too
    at = before;
  }
  return size + width;
}

void count(PoleBlock& block, Complex pole) {
  if (std::abs(pole) < kZeroModulus)
    ++block.zero;
  else
    ++(pole.real() > 0 ? block.positive : block.negative);
}

PoleBlock describe(const Schur& schur, Index first, Index size) {
  PoleBlock block{first, size};
  for (Index i = first, width = 1; i < first + size; i += width) {
    width = schur.width(i);
    if (width == 1) {
      count(block, schur.T(i, i));
      continue;
    }
    const auto [upper, lower] = eigenvalues(schur.T.block<2, 2>(i, i));
    if (upper.imag() > 0 && std::abs(upper) >= kZeroModulus) {
      ++block.pairs;
      block.phase += std::arg(upper);
    } else {
      count(block, upper);
      count(block, lower);
    }
  }
  if (block.pairs > 0) block.phase /= block.pairs;
  return block;
}

}  // namespace

PoleBlocks pole_blocks(const MatrixXd& matrix) {
  auto [form, vectors] = real_schur(matrix);
  Schur schur{std::move(form), vectors, vectors.transpose()};
  PoleBlocks result;
  for (Index first = 0; first < schur.size();) {
    Index size = schur.width(first);
    MatrixXd X = splitting(schur, first, size);
    while (!(X.norm() <= kMostNorm)) {
      const Index joined = join_nearest(schur, first, size);
      if (joined == size && X.allFinite()) break;
      size = joined == size ? schur.size() - first : joined;
      X = splitting(schur, first, size);
    }
    const Index begin = first + size, rest = schur.size() - begin;
    schur.T.block(first, begin, size, rest).setZero();
    schur.basis.rightCols(rest) += schur.basis.middleCols(first, size) * X;
    schur.inverse.middleRows(first, size) -= X * schur.inverse.bottomRows(rest);
    result.blocks.push_back(describe(schur, first, size));
    first = begin;
  }
  result.basis = std::move(schur.basis);
  result.inverse = std::move(schur.inverse);
  result.diagonal = std::move(schur.T);
  return result;
}

}  // namespace emberfold::dytex::detail
