// SPDX-License-Identifier: Apache-2.0
#include "sketch/inpainting/multigrid.hpp"

#include <algorithm>
#include <utility>

namespace emberfold::sketch {

namespace {

/// store(k, Σ link·x over the neighbours of cell k) along one row of one colour.
template <class Real, class Store>
void gather(const Level<Real>& level, int colour, int y, Store store) {
  const auto own = static_cast<std::size_t>(colour);
  const Real* east = level.east[own].row(y);
  const Real* south = level.south[own].row(y);
  const Real* west = Neighbours(level.east[1 - own], colour, y).west;
  const Real* north = Neighbours(level.south[1 - own], colour, y).north;
  const Neighbours x(level.x[1 - own], colour, y);
  for (int k = 0; k < level.x[0].span(); ++k)
    store(k, east[k] * x.east[k] + west[k] * x.west[k] + (south[k] * x.south[k] + north[k] * x.north[k]));
}

/// Half a Gauss–Seidel sweep.
template <class Real>
void relax(Level<Real>& level, std::size_t colour) {
  for (int y = 0; y < level.height; ++y) {
    Real* __restrict x = level.x[colour].row(y);
    const Real* b = level.b[colour].row(y);
    const Real* inverse = level.inverse[colour].row(y);
    gather(level, static_cast<int>(colour), y, [=](int k, Real flow) { x[k] = (b[k] + flow) * inverse[k]; });
  }
}

/// The residual summed over blocks. After the first sweep from nothing it is zero on black cells, and on red
/// ones what flows in from the black.
template <class Real>
void restrict_residual(const Level<Real>& fine, Level<Real>& coarse, std::vector<Real>& cells) {
  for (int y = 0; y < coarse.height; ++y) {
    std::fill(cells.begin(), cells.end(), Real(0));
    Real* __restrict sum = cells.data();
    for (int row = 2 * y; row < std::min(2 * y + 2, fine.height); ++row)
      gather(fine, 0, row, [=](int k, Real flow) { sum[k] += flow; });
    split_row(cells.data(), y, coarse.b);
  }
}

/// Gives the red cells the coarse solution, in addition or instead of what they have.
template <class Real>
void prolong(const Level<Real>& coarse, Level<Real>& fine, bool add, std::vector<Real>& cells) {
  const Real* e = cells.data();
  for (int y = 0; y < fine.height; ++y) {
    if (y % 2 == 0) join_row(coarse.x, y / 2, cells.data());
    Real* __restrict x = fine.x[0].row(y);
    const Real keep = add ? 1 : 0;
    for (int k = 0; k < fine.x[0].span(); ++k) x[k] = keep * x[k] + e[k];
  }
}

template <class Real>
void set_inverse(Level<Real>& level) {
  for (int colour = 0; colour < 2; ++colour) {
    const auto own = static_cast<std::size_t>(colour);
    for (int y = 0; y < level.height; ++y) {
      const Real* sink = level.sink[own].row(y);
      const Real* east = level.east[own].row(y);
      const Real* south = level.south[own].row(y);
      const Real* west = Neighbours(level.east[1 - own], colour, y).west;
      const Real* north = Neighbours(level.south[1 - own], colour, y).north;
      Real* __restrict inverse = level.inverse[own].row(y);
      for (int k = 0; k < level.sink[0].span(); ++k) {
        const Real diagonal = sink[k] + east[k] + west[k] + south[k] + north[k];
        inverse[k] = diagonal > 0 ? 1 / diagonal : 0;
      }
    }
  }
}

template <class Real>
Level<Real> coarser(const Level<Real>& fine) {
  Level<Real> coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
  auto east = row_buffer(fine.x[0]), south = east, sink = east;
  for (int y = 0; y < coarse.height; ++y) {
    const int top = 2 * y, bottom = 2 * y + 1;  // which may be the row of zeros behind the last
    const Real *east_top = fine.east[1].row(top), *east_bottom = fine.east[0].row(bottom);
    const Real *south_left = fine.south[1].row(bottom), *south_right = fine.south[0].row(bottom);
    std::fill(sink.begin(), sink.end(), Real(0));
    for (int k = 0; k < fine.x[0].span(); ++k) {
      east[static_cast<std::size_t>(k)] = (east_top[k] + east_bottom[k]) / 2;
      south[static_cast<std::size_t>(k)] = (south_left[k] + south_right[k]) / 2;
    }
    for (const Half<Real>& half : fine.sink)
      for (const Real* row : {half.row(top), half.row(bottom)})
        for (int k = 0; k < half.span(); ++k)
          sink[static_cast<std::size_t>(k)] += row[k] * sink_share(row[k]);
    split_row(east.data(), y, coarse.east);
    split_row(south.data(), y, coarse.south);
    split_row(sink.data(), y, coarse.sink);
  }
  set_inverse(coarse);
  return coarse;
}

/// levels[i].b for i > 0 from levels[0].b.
template <class Real>
void restrict_inflow(std::vector<Level<Real>>& levels, std::vector<Real>& cells) {
  for (std::size_t i = 0; i + 1 < levels.size(); ++i) {
    const Level<Real>& fine = levels[i];
    for (int y = 0; y < levels[i + 1].height; ++y) {
      std::fill(cells.begin(), cells.end(), Real(0));
      Real* __restrict sum = cells.data();
      for (std::size_t c = 0; c < 2; ++c)
        for (int row = 2 * y; row < 2 * y + 2; ++row) {
          const Real* b = fine.b[c].row(row);
          const Real* sink = fine.sink[c].row(row);
          for (int k = 0; k < fine.x[0].span(); ++k) sum[k] += b[k] * sink_share(sink[k]);
        }
      split_row(cells.data(), y, levels[i + 1].b);
    }
  }
}

template <class Real>
void cycle_from(std::vector<Level<Real>>& levels, std::size_t index, std::vector<Real>& cells) {
  Level<Real>& level = levels[index];
  for (int y = 0; y < level.height; ++y) {
    Real* __restrict x = level.x[0].row(y);
    const Real* b = level.b[0].row(y);
    const Real* inverse = level.inverse[0].row(y);
    for (int k = 0; k < level.x[0].span(); ++k) x[k] = b[k] * inverse[k];
  }
  if (index + 1 == levels.size()) return;
  relax(level, 1);
  restrict_residual(level, levels[index + 1], cells);
  cycle_from(levels, index + 1, cells);
  prolong(levels[index + 1], level, true, cells);
  // The backward sweep keeps M symmetric.
  relax(level, 1);
  relax(level, 0);
}

}  // namespace

template <class Real>
Level<Real>::Level(int width_, int height_)
    : width(width_),
      height(height_),
      east(make_board<Real>(width_, height_)),
      south(east),
      sink(east),
      inverse(east),
      x(east),
      b(east) {}

template <class Real>
std::vector<Level<Real>> coarsen(Level<Real> finest) {
  set_inverse(finest);
  std::vector<Level<Real>> levels;
  levels.push_back(std::move(finest));
  while (levels.back().width > 1 || levels.back().height > 1) levels.push_back(coarser(levels.back()));
  return levels;
}

template <class Real>
void solve_roughly(std::vector<Level<Real>>& levels) {
  auto cells = row_buffer(levels.front().x[0]);
  restrict_inflow(levels, cells);
  relax(levels.back(), 0);
  for (std::size_t i = levels.size() - 1; i-- > 0;) {
    prolong(levels[i + 1], levels[i], false, cells);
    relax(levels[i], 1);
    relax(levels[i], 0);
  }
}

template <class Real>
void cycle(std::vector<Level<Real>>& levels) {
  auto cells = row_buffer(levels.front().x[0]);
  cycle_from(levels, 0, cells);
}

template struct Level<float>;
template struct Level<double>;
template std::vector<Level<float>> coarsen(Level<float>);
template std::vector<Level<double>> coarsen(Level<double>);
template void solve_roughly(std::vector<Level<float>>&);
template void solve_roughly(std::vector<Level<double>>&);
template void cycle(std::vector<Level<float>>&);
template void cycle(std::vector<Level<double>>&);

}  // namespace emberfold::sketch
