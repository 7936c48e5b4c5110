// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

constexpr int kLevelRangeCell = 8;  ///< px, side of a cell

/// Refers to the cells of a LevelRange (level_range.hpp), row by row.
struct LevelCells {
  int columns = 0, rows = 0;
  int channels = 1;                    ///< 1 or 3
  const std::uint8_t* low = nullptr;   ///< `channels` values a cell
  const std::uint8_t* high = nullptr;  ///< the same
};

/// Clamps the levels of patches to a range of at least one cell, as clamp_levels of level_range.hpp says.
graph::AttributeGraph clamp_levels(const graph::AttributeGraph& graph, const LevelCells& range);

}  // namespace emberfold::sketch
