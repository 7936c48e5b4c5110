// SPDX-License-Identifier: Apache-2.0
#include "dytex/distributed/stripe_products.hpp"

#include <algorithm>

#include "core/parallel.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr Eigen::Index kStripeRows = 512;  // converted to double at a time
constexpr Eigen::Index kStripeTile = 32;   // columns of a tile of MᵀM

Eigen::Index column_count(const SideBySide& columns) {
  Eigen::Index count = 0;
  for (const Eigen::MatrixXf* part : columns) count += part->cols();
  return count;
}

/// Converts rows from `row` on of the columns [first, first + to.cols()) to double.
void convert_part(const SideBySide& columns, Eigen::Index row, Eigen::Index rows, Eigen::Index first,
                  Eigen::MatrixXd& to) {
  Eigen::Index at = 0;
  for (const Eigen::MatrixXf* part : columns) {
    const Eigen::Index begin = std::max(first, at), end = std::min(first + to.cols(), at + part->cols());
    if (begin < end)
      to.block(0, begin - first, rows, end - begin) =
          part->block(row, begin - at, rows, end - begin).cast<double>();
    at += part->cols();
  }
}

}  // namespace

void add_stripe_products(const SideBySide& columns, Eigen::MatrixXd& sum, const core::Context& context) {
  const Eigen::Index count = column_count(columns), rows = columns.front()->rows(),
                     tiles = (count + kStripeTile - 1) / kStripeTile;
  core::parallel_for(static_cast<std::size_t>(tiles * tiles), context, [&](std::size_t task) {
    const Eigen::Index i0 = static_cast<Eigen::Index>(task) / tiles * kStripeTile,
                       j0 = static_cast<Eigen::Index>(task) % tiles * kStripeTile,
                       height = std::min(kStripeTile, count - i0), width = std::min(kStripeTile, count - j0);
    if (j0 > i0) return;
    Eigen::MatrixXd left(kStripeRows, height), right(kStripeRows, width);
    for (Eigen::Index row = 0; row < rows; row += kStripeRows) {
      context.check();
      const Eigen::Index some = std::min(kStripeRows, rows - row);
      convert_part(columns, row, some, i0, left);
      convert_part(columns, row, some, j0, right);
      sum.block(i0, j0, height, width).noalias() += left.topRows(some).transpose() * right.topRows(some);
    }
  });
}

Eigen::MatrixXf product(const SideBySide& columns, const Eigen::MatrixXd& right,
                        const core::Context& context) {
  const Eigen::Index count = column_count(columns), rows = columns.front()->rows();
  Eigen::MatrixXf result(rows, right.cols());
  core::parallel_for(
      static_cast<std::size_t>((rows + kStripeRows - 1) / kStripeRows), context, [&](std::size_t i) {
        const auto row = static_cast<Eigen::Index>(i) * kStripeRows, some = std::min(kStripeRows, rows - row);
        Eigen::MatrixXd block(some, count);
        convert_part(columns, row, some, 0, block);
        result.middleRows(row, some) = (block * right).cast<float>();
      });
  return result;
}

}  // namespace emberfold::dytex::detail
