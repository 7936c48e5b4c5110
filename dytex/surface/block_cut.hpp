// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <opencv2/core/types.hpp>

/// Seams of blocks of any shape. Inner header of surfaces.
namespace emberfold::dytex::detail {

/// State of a cell that a block covers.
enum class CellState : unsigned char {
  outside,  // no texel of the chart
  empty,    // has to become the block's
  there,    // filled by earlier blocks: stays theirs, or becomes the block's
  held      // stays unchanged
};

/// Costs of a cell at the border of its chart: unchanged, and as the block's.
struct BorderCost {
  double there = 0, own = 0;
};

/// Divides a block's cells by the minimum cut between `empty` and `held` ones: true for the block's own. The
/// cost of a seam between two cells is the sum of their errors, of each Σ_t (p₁ − p₂)² between earlier blocks
/// and the block; an empty cell counts as its neighbour. `borders` costs more; it may be empty. Row by row,
/// all of the block's size.
std::vector<bool> cut_cells(cv::Size block, const std::vector<CellState>& states,
                            std::span<const double> errors, std::span<const BorderCost> borders = {});

}  // namespace emberfold::dytex::detail
