// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace emberfold::graph {

/// In an assignment: this row has no column.
inline constexpr std::size_t kUnassigned = ~std::size_t{0};

/// The assignment of rows to columns, min(rows, columns) pairs, at the least total cost: for each row its
/// column or kUnassigned. `cost`: rows × columns, row after row, finite (InputError otherwise). Successive
/// shortest paths (Jonker & Volgenant 1987). O(min² · max).
std::vector<std::size_t> assign(std::size_t rows, std::size_t columns, std::span<const double> cost);

}  // namespace emberfold::graph
