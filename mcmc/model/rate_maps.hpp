// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "core/rng.hpp"
#include "graph/patch.hpp"

namespace emberfold::mcmc {

/// Holds one number for each cell of a square grid over the frame, row by row.
struct CellMap {
  double cell = 16;  ///< px, side of a cell
  int columns = 0, rows = 0;
  std::vector<double> values;  ///< columns · rows

  /// Returns the index of the cell that holds a place; outside the frame the nearest cell.
  [[nodiscard]] std::size_t index(graph::Point p) const;
  [[nodiscard]] double at(graph::Point p) const { return values[index(p)]; }
  bool operator==(const CellMap&) const = default;
};

/// Makes a map of zeros that covers a frame of width × height px.
/// Cells are 16 px wide, or so wide that the longer side has at most 48 of them.
CellMap make_cell_grid(int width, int height);

/// Smooths a map by a Gaussian of SD `sigma` cells and returns the new values; 0 changes nothing.
/// Each cell's value is distributed in shares that sum to 1, so the borders lose no mass. O(cells · sigma).
std::vector<double> spread_over_cells(const CellMap& map, double sigma);

/// Draws a place, px, with the map's values as the cells' weights: not negative, one at least above 0.
graph::Point draw_place(const CellMap& map, core::Rng& rng);

/// Returns the map's value at a place, bilinear between the centres of the cells.
double interpolate(const CellMap& map, graph::Point p);

}  // namespace emberfold::mcmc
