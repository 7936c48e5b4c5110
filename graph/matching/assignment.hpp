// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace emberfold::graph {

/// In an assignment: this row has no column.
inline constexpr std::size_t kUnassigned = ~std::size_t{0};

/// The assignment of rows to columns, min(rows, columns) pairs, at the least total cost: for each row its
/// column or kUnassigned. `cost`: rows × columns, row after row, finite (InputError otherwise). Successive
/// shortest paths (Jonker & Volgenant 1987). O(min² · max).
std::vector<std::size_t> assign(std::size_t rows, std::size_t columns, std::span<const double> cost);

/// A pair that may be made, and what it would gain.
struct Candidate {
  std::uint32_t row = 0, column = 0;
  double gain = 0;  ///< > 0, finite
};

/// The one-to-one pairs (row, column) among the candidates that gain most in all, sorted; rows and columns
/// may stay alone. Candidates in any order, each pair once. Groups that no candidate joins are solved apart:
/// O(n³) in the largest of them.
std::vector<std::pair<std::uint32_t, std::uint32_t>> assign(std::span<const Candidate> candidates);

}  // namespace emberfold::graph
