// SPDX-License-Identifier: Apache-2.0
// For the sketch library's own sources; not installed.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace emberfold::sketch {

/// Holds one colour of a chequerboard of cells.
/// Cell (x, y) of colour (x + y) % 2 is number x / 2 of row y. The four neighbours of a cell lie in the other
/// half, those of the next cell beside them, so that a sweep over one colour is a loop over contiguous
/// memory. Zeros lie around and behind the rows; loops run over span() values, a multiple of 8, and leave the
/// zeros behind a row as they are.
template <class Real>
class Half {
 public:
  Half() = default;
  Half(int width, int height)
      : span_(((width + 1) / 2 + 7) / 8 * 8),
        stride_(static_cast<std::size_t>(span_) + 8),
        values_(stride_ * (static_cast<std::size_t>(height) + 2) + 8) {}
  [[nodiscard]] int span() const { return span_; }
  /// Returns a row; y from −1 to height.
  [[nodiscard]] Real* row(int y) { return values_.data() + offset(y); }
  [[nodiscard]] const Real* row(int y) const { return values_.data() + offset(y); }

 private:
  [[nodiscard]] std::size_t offset(int y) const { return stride_ * static_cast<std::size_t>(y + 1) + 8; }
  int span_ = 0;
  std::size_t stride_ = 0;
  std::vector<Real> values_;
};

/// Both halves: [0] is red, the colour of cell (0, 0), [1] black.
template <class Real>
using Board = std::array<Half<Real>, 2>;

/// Returns a board of zeros.
template <class Real>
Board<Real> make_board(int width, int height) {
  return {Half<Real>(width, height), Half<Real>(width, height)};
}

/// Points to the neighbours of a row of one colour.
/// west[k], east[k], north[k], south[k] of the other half are those of cell k.
template <class Real>
struct Neighbours {
  const Real *west, *east, *north, *south;
  Neighbours(const Half<Real>& other, int colour, int y)
      : Neighbours(other.row(y - 1), other.row(y), other.row(y + 1), colour, y) {}
  Neighbours(const Real* above, const Real* same, const Real* below, int colour, int y)
      : west(same + (y + colour) % 2 - 1), east(west + 1), north(above), south(below) {}
  /// Returns the sum of all four, always added in the same order.
  [[nodiscard]] Real sum(int k) const { return west[k] + east[k] + (north[k] + south[k]); }
};

/// Returns room for one row of cells, as split_row and join_row need it.
template <class Real>
std::vector<Real> row_buffer(const Half<Real>& half) {
  return std::vector<Real>(2 * static_cast<std::size_t>(half.span()) + 16);
}
/// Splits a row of cells by colour.
template <class Real>
void split_row(const Real* cells, int y, Board<Real>& board) {
  Real* __restrict even = board[static_cast<std::size_t>(y % 2)].row(y);
  Real* __restrict odd = board[static_cast<std::size_t>(1 - y % 2)].row(y);
  for (int k = 0; k < board[0].span(); ++k) {
    even[k] = cells[2 * k];
    odd[k] = cells[2 * k + 1];
  }
}
/// Joins the two colours of a row of cells.
template <class Real>
void join_row(const Board<Real>& board, int y, Real* __restrict cells) {
  const Real* even = board[static_cast<std::size_t>(y % 2)].row(y);
  const Real* odd = board[static_cast<std::size_t>(1 - y % 2)].row(y);
  for (int k = 0; k < board[0].span(); ++k) {
    cells[2 * k] = even[k];
    cells[2 * k + 1] = odd[k];
  }
}

/// Holds a network of conductances on a grid: links to the east and south neighbour and a sink to 0. A x =
/// (sink + Σ link)·x − Σ link·x of the neighbours.
template <class Real>
struct Level {
  Level(int width_, int height_);
  int width, height;
  Board<Real> east, south, sink;
  Board<Real> inverse;  ///< 1/(sink + Σ link), 0 where nothing is to be solved
  Board<Real> x, b;
};

/// Returns the share of a sink that is left when its cell becomes part of a 2×2 block.
/// It holds for the inflow, too. The resistance of half a cell is put before the sink.
template <class Real>
Real sink_share(Real sink) {
  return 2 / (2 + sink);
}

/// Builds the networks of 2×2 blocks, of blocks of these, and so on to a single cell. `finest` comes with
/// links and sinks. A link between blocks is half the sum of the links it stands for, being twice as long. So
/// Laplace's equation remains Laplace's equation on every level, straight held lines keep their distance, and
/// blocks without a link stay apart. (Galerkin's product, without the half, is twice too stiff: Braess 1995,
/// "Towards algebraic multigrid for elliptic problems of second order".)
template <class Real>
std::vector<Level<Real>> coarsen(Level<Real> finest);

/// Approximates levels[0].x = A⁻¹ levels[0].b in one way up from the single cell, b being the inflow through
/// the sinks. Uses b of all levels.
template <class Real>
void solve_roughly(std::vector<Level<Real>>& levels);

/// Computes levels[0].x = M⁻¹ levels[0].b by one V-cycle, M symmetric and positive definite, close to A.
template <class Real>
void cycle(std::vector<Level<Real>>& levels);

}  // namespace emberfold::sketch
