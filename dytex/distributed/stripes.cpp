// SPDX-License-Identifier: Apache-2.0
#include "dytex/distributed/stripes.hpp"

#include <algorithm>
#include <bit>
#include <exception>
#include <vector>

#include "dytex/distributed/together.hpp"
#include "dytex/learning/gram.hpp"

namespace emberfold::dytex {

namespace {

constexpr std::size_t kStripes = 64;

std::span<double> column_part(Eigen::MatrixXd& matrix, Eigen::Index column, bool lower) {
  const Eigen::Index first = lower ? column : 0;
  return {matrix.col(column).data() + first, static_cast<std::size_t>(matrix.rows() - first)};
}

/// Sends or receives some columns at a time, so that no second copy of the matrix is held.
template <class Pass>
void pass_columns(Eigen::MatrixXd& matrix, bool lower, const Pass& pass) {
  constexpr Eigen::Index kAtOnce = 256;
  std::vector<double> packed;
  for (Eigen::Index j0 = 0; j0 < matrix.cols(); j0 += kAtOnce) {
    const Eigen::Index j1 = std::min(j0 + kAtOnce, matrix.cols());
    std::size_t size = 0;
    for (Eigen::Index j = j0; j < j1; ++j) size += column_part(matrix, j, lower).size();
    packed.resize(size);
    pass(j0, j1, packed);
  }
}

class TreeSum {
 public:
  TreeSum(Communicator& ranks, const Stripes& stripes, bool exact, bool lower,
          const std::function<void(std::size_t, Eigen::MatrixXd&)>& term, Eigen::Index rows,
          Eigen::Index columns)
      : ranks_(ranks),
        stripes_(stripes),
        exact_(exact),
        lower_(lower),
        term_(term),
        rows_(rows),
        columns_(columns) {}

  /// The sum of the stripes from `begin` on, a subtree of `size` leaves; on the owner of the first.
  Eigen::MatrixXd sum(std::size_t begin, std::size_t size) {
    const std::size_t end = std::min(begin + size, stripes_.count()), own = stripes_.first_of(ranks_.rank()),
                      own_end = stripes_.first_of(ranks_.rank() + 1);
    if (begin >= end || end <= own || begin >= own_end) return {};
    if (size == 1 || (exact_ && begin >= own && end <= own_end)) return leaves(begin, end);
    const std::size_t half = size / 2, middle = begin + half;
    Eigen::MatrixXd left = sum(begin, half), right = sum(middle, half);
    if (middle >= end) return left;
    const int to = stripes_.owner(begin), from = stripes_.owner(middle);
    if (from == to) {
      if (ranks_.rank() == to) left += right;
    } else if (ranks_.rank() == from) {
      send(to, right);
    } else if (ranks_.rank() == to) {
      add_received(from, left);
    }
    return left;
  }
  /// Returns what a term threw; the sum continued without it, as other ranks wait for it.
  [[nodiscard]] std::exception_ptr failure() const { return failure_; }

 private:
  Eigen::MatrixXd leaves(std::size_t begin, std::size_t end) {
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(rows_, columns_);
    for (std::size_t stripe = begin; stripe < end && !failure_; ++stripe) {
      try {
        term_(stripe, result);
      } catch (...) {
        failure_ = std::current_exception();
      }
    }
    return result;
  }

  void send(int to, Eigen::MatrixXd& matrix) {
    pass_columns(matrix, lower_, [&](Eigen::Index j0, Eigen::Index j1, std::vector<double>& packed) {
      auto at = packed.begin();
      for (Eigen::Index j = j0; j < j1; ++j) at = std::ranges::copy(column_part(matrix, j, lower_), at).out;
      ranks_.send(to, std::as_bytes(std::span(packed)));
    });
  }

  void add_received(int from, Eigen::MatrixXd& matrix) {
    pass_columns(matrix, lower_, [&](Eigen::Index j0, Eigen::Index j1, std::vector<double>& packed) {
      ranks_.receive(from, std::as_writable_bytes(std::span(packed)));
      const double* at = packed.data();
      for (Eigen::Index j = j0; j < j1; ++j)
        for (double& value : column_part(matrix, j, lower_)) value += *at++;
    });
  }

  Communicator& ranks_;
  const Stripes& stripes_;
  bool exact_, lower_;
  const std::function<void(std::size_t, Eigen::MatrixXd&)>& term_;
  Eigen::Index rows_, columns_;
  std::exception_ptr failure_;
};

}  // namespace

Stripes::Stripes(std::size_t values, int ranks)
    : values_(values),
      ranks_(static_cast<std::size_t>(ranks)),
      blocks_((values + detail::kBlock - 1) / detail::kBlock),
      count_(std::min(kStripes, blocks_)) {}

std::size_t Stripes::begin(std::size_t stripe) const {
  return std::min(blocks_ * stripe / count_ * detail::kBlock, values_);
}

std::size_t Stripes::first_of(int rank) const {
  return (static_cast<std::size_t>(rank) * count_ + ranks_ - 1) / ranks_;
}

int Stripes::owner(std::size_t stripe) const {
  return static_cast<int>(stripe * ranks_ / count_);
}

Eigen::MatrixXd sum_stripes(Communicator& ranks, const Stripes& stripes, Eigen::Index rows,
                            Eigen::Index columns, bool exact, bool lower,
                            const std::function<void(std::size_t, Eigen::MatrixXd&)>& term) {
  TreeSum tree(ranks, stripes, exact, lower, term, rows, columns);
  Eigen::MatrixXd result = tree.sum(0, std::bit_ceil(stripes.count()));
  together(ranks, [&] {
    if (tree.failure()) std::rethrow_exception(tree.failure());
  });
  return result;
}

}  // namespace emberfold::dytex
