// SPDX-License-Identifier: Apache-2.0
#include "dytex/distances/pair_gram.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "core/parallel.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr Eigen::Index kRows = 512;  // values of a block
constexpr Eigen::Index kParts = 16;  // partial sums; fixed, so that results do not depend on threads
constexpr int kMostDoublings = 64;   // 2^64 frames

std::string size_text(const core::ClipInfo& info) {
  return std::to_string(info.width) + "×" + std::to_string(info.height) +
         (info.channels == 3 ? " in colour" : " in grey");
}

/// Puts the products of components at the places of the states that show them: 0 for those that no frame
/// shows.
Eigen::MatrixXd place_products(const Eigen::MatrixXd& gram, const LinearDynamicTexture& p,
                               const LinearDynamicTexture& q) {
  std::vector<Eigen::Index> places;
  for (Eigen::Index i = 0; i < p.components(); ++i) places.push_back(i);
  for (Eigen::Index i = 0; i < q.components(); ++i) places.push_back(p.order() + i);
  const Eigen::Index size = p.order() + q.order() + 1;
  places.push_back(size - 1);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(size, size);
  result(places, places) = gram;
  return result;
}

}  // namespace

void check_pair(const LinearDynamicTexture& p, const LinearDynamicTexture& q) {
  const core::ClipInfo &a = p.info, &b = q.info;
  if (a.width != b.width || a.height != b.height || a.channels != b.channels)
    throw core::InputError("frames of " + size_text(a) + " and of " + size_text(b) +
                           " cannot be compared; both must have the same size and channels");
}

PairGram pair_gram(const LinearDynamicTexture& p, const LinearDynamicTexture& q,
                   const Eigen::VectorXd& factors) {
  check_pair(p, q);
  const Eigen::Index m = p.pixels(), np = p.components(), nq = q.components(), size = np + nq + 1;
  const Eigen::Index blocks = (m + kRows - 1) / kRows;
  const Eigen::VectorXd roots = factors.cwiseSqrt();
  std::vector<Eigen::MatrixXd> parts(kParts, Eigen::MatrixXd::Zero(size, size));
  core::parallel_for(kParts, {}, [&](std::size_t part) {
    const auto s = static_cast<Eigen::Index>(part);
    Eigen::MatrixXd block;
    for (Eigen::Index b = blocks * s / kParts; b < blocks * (s + 1) / kParts; ++b) {
      const Eigen::Index row = b * kRows, rows = std::min(kRows, m - row);
      block.resize(rows, size);
      block.leftCols(np) = p.C.middleRows(row, rows).cast<double>();
      block.middleCols(np, nq) = q.C.middleRows(row, rows).cast<double>();
      block.col(size - 1) =
          p.mean.segment(row, rows).cast<double>() - q.mean.segment(row, rows).cast<double>();
      if (roots.size() > 0) block.array().colwise() *= roots.segment(row, rows).array();
      parts[part].selfadjointView<Eigen::Lower>().rankUpdate(block.transpose());
    }
  });
  for (std::size_t part = 1; part < parts.size(); ++part) parts[0] += parts[part];
  const Eigen::MatrixXd sum = parts[0].selfadjointView<Eigen::Lower>();
  Eigen::VectorXd weights(size);
  weights << p.weights, q.weights, 1;
  return {p.order(), q.order(), place_products(weights.asDiagonal() * sum * weights.asDiagonal(), p, q)};
}

PairGram PairGram::swapped() const {
  std::vector<Eigen::Index> order;
  for (Eigen::Index i = 0; i <= p + q; ++i) order.push_back(i < q ? p + i : i < p + q ? i - q : i);
  PairGram result{q, p, products(order, order)};
  result.products.col(p + q).head(p + q) *= -1;
  result.products.row(p + q).head(p + q) *= -1;
  return result;
}

Eigen::MatrixXd doubled_sum(Eigen::MatrixXd F, Eigen::MatrixXd G, Eigen::MatrixXd W) {
  for (int step = 0; step < kMostDoublings && W.allFinite(); ++step) {
    const Eigen::MatrixXd more = F * W * G;
    W += more;
    F = (F * F).eval();
    G = (G * G).eval();
    const double size = W.norm();
    if (std::isfinite(size) && more.norm() <= std::numeric_limits<double>::epsilon() * size) return W;
  }
  throw core::NumericalError("the states of a model that is not stable have no sum over all frames");
}

}  // namespace emberfold::dytex::detail
