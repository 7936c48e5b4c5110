// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include <Eigen/Core>

#include "dytex/distributed/communicator.hpp"

namespace emberfold::dytex {

/// A frame's values cut into stripes of neighbouring ones, the same at any number of ranks: 64, or one for
/// each sum block of 256 values if those are fewer. Each rank owns a run of stripes; rank 0 owns the first.
class Stripes {
 public:
  Stripes(std::size_t values, int ranks);

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] std::size_t values() const { return values_; }  ///< of a frame: m
  [[nodiscard]] std::size_t begin(std::size_t stripe) const;    ///< its first value; count() is allowed
  [[nodiscard]] std::size_t size(std::size_t stripe) const { return begin(stripe + 1) - begin(stripe); }
  /// Returns the first stripe of a rank; those up to the next rank's first are its own. `ranks` is allowed.
  [[nodiscard]] std::size_t first_of(int rank) const;
  [[nodiscard]] int owner(std::size_t stripe) const;

 private:
  std::size_t values_, ranks_, blocks_, count_;
};

/// Adds matrices of `rows` × `columns`, one of each stripe, along a fixed tree; rank 0 returns the sum,
/// others return anything. `term(stripe, sum)` adds a stripe's matrix to `sum` and is called on the stripe's
/// owner alone. The same bits at any number of ranks. `exact`: sums of these numbers are not rounded, so that
/// a rank may add its own as they come, in less memory. `lower`: only the lower half is sent and added; the
/// matrix is square. Throws FailedTogether.
Eigen::MatrixXd sum_stripes(Communicator& ranks, const Stripes& stripes, Eigen::Index rows,
                            Eigen::Index columns, bool exact, bool lower,
                            const std::function<void(std::size_t, Eigen::MatrixXd&)>& term);

}  // namespace emberfold::dytex
