// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "dytex/distributed/communicator.hpp"

namespace emberfold::dytex {

/// Reports that a rank failed and that all ranks know: each of them throws it.
class FailedTogether : public std::exception {
 public:
  FailedTogether(int rank, const std::exception_ptr& cause)
      : rank_(rank), cause_(cause) {}  // NOLINT(bugprone-throw-keyword-missing): it is kept
  [[nodiscard]] const char* what() const noexcept override { return "a rank failed"; }
  [[nodiscard]] int rank() const { return rank_; }  ///< the first that failed
  /// Throws what that rank threw: core::InputError, IoError, NumericalError, Cancelled, std::bad_alloc or
  /// std::runtime_error.
  [[noreturn]] void rethrow() const { std::rethrow_exception(cause_); }

 private:
  int rank_;
  std::exception_ptr cause_;
};

/// Calls `body` on every rank and returns what each returned, by rank. Where one throws, all throw
/// FailedTogether, so that no rank waits for one that is gone. The body sends and receives nothing.
std::vector<std::int64_t> tell_together(Communicator& ranks, const std::function<std::int64_t()>& body);
/// Does the same for a body that returns nothing.
void together(Communicator& ranks, const std::function<void()>& body);

/// Sends the bytes of rank 0 to every rank. They have the same size on all.
void broadcast(Communicator& ranks, std::span<std::byte> bytes);
/// Does the same for a number, and for a matrix, whose size the others need not know.
std::int64_t broadcast_number(Communicator& ranks, std::int64_t value);
void broadcast_matrix(Communicator& ranks, Eigen::MatrixXd& matrix);

}  // namespace emberfold::dytex
