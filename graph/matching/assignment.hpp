// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace emberfold::graph {

/// Marks a row without a column in an assignment.
inline constexpr std::size_t kUnassigned = ~std::size_t{0};

/// Assigns min(rows, columns) rows to columns one to one at the least total cost.
/// Returns the column of each row, or kUnassigned. `cost`: rows × columns, row by row. Throws InputError for
/// a wrong size or a cost that is not finite. Successive shortest paths (Jonker & Volgenant 1987), O(min² ·
/// max).
std::vector<std::size_t> assign(std::size_t rows, std::size_t columns, std::span<const double> cost);

/// A pair that an assignment may contain, and its gain.
struct Candidate {
  std::uint32_t row = 0, column = 0;
  double gain = 0;  ///< > 0, finite
};

/// Selects the one-to-one pairs (row, column) of the greatest total gain, sorted.
/// Rows and columns may stay unpaired. `candidates`: in any order, each pair once. Throws InputError for a
/// gain that is not finite and above 0. Groups that no candidate connects are solved separately: O(n³) in the
/// largest.
std::vector<std::pair<std::uint32_t, std::uint32_t>> assign(std::span<const Candidate> candidates);

}  // namespace emberfold::graph
