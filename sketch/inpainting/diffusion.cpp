// SPDX-License-Identifier: Apache-2.0
#include "sketch/inpainting/diffusion.hpp"

#include <algorithm>
#include <cmath>

namespace emberfold::sketch {

namespace {

constexpr int kVectorLanes = 8;  // divides every span

/// Eight partial sums in a fixed order, as vector units have them.
template <class Real>
double dot(const Real* a, const Real* b, int n) {
  std::array<Real, kVectorLanes> lanes{};
  for (int k = 0; k < n; k += kVectorLanes)
    for (int j = 0; j < kVectorLanes; ++j) lanes[static_cast<std::size_t>(j)] += a[k + j] * b[k + j];
  double sum = 0;
  for (const Real lane : lanes) sum += static_cast<double>(lane);
  return sum;
}

template <class Real>
double largest(const Real* a, int n) {
  std::array<Real, kVectorLanes> lanes{};
  for (int k = 0; k < n; k += kVectorLanes)
    for (int j = 0; j < kVectorLanes; ++j) {
      const Real value = std::abs(a[k + j]);
      Real& lane = lanes[static_cast<std::size_t>(j)];
      lane = value > lane ? value : lane;
    }
  return static_cast<double>(*std::max_element(lanes.begin(), lanes.end()));
}

}  // namespace

template <class Real>
Diffusion<Real>::Diffusion(int width, int height, const std::vector<const std::uint8_t*>& held, Real sink)
    : width_(width),
      height_(height),
      unknown_(make_board<Real>(width, height)),
      inverse_(unknown_),
      r_(width, height),
      z_(r_),
      p_(r_),
      q_(r_) {
  span_ = r_.span();
  for (auto& row : ring_) row.resize(static_cast<std::size_t>(span_) + 16);
  cells_ = row_buffer(r_);
  Board<Real> diagonal = unknown_;
  std::vector<Real> unknown(cells_.size()), degree(cells_.size()), inverse(cells_.size());
  for (int y = 0; y < height; ++y) {
    const std::uint8_t* row = held[static_cast<std::size_t>(y)];
    const auto full = static_cast<Real>(2 + (y > 0) + (y + 1 < height)) + sink;
    for (int x = 0; x < width; ++x) unknown[static_cast<std::size_t>(x)] = static_cast<Real>(row[x] == 0);
    for (std::size_t i = 0; i < degree.size(); ++i) degree[i] = unknown[i] * full;
    degree[0] -= unknown[0];
    degree[static_cast<std::size_t>(width) - 1] -= unknown[static_cast<std::size_t>(width) - 1];
    // A frame of one pixel has no neighbours; its field is never asked for.
    for (std::size_t i = 0; i < degree.size(); ++i) inverse[i] = unknown[i] / std::max(degree[i], Real(1));
    split_row(unknown.data(), y, unknown_);
    split_row(degree.data(), y, diagonal);
    split_row(inverse.data(), y, inverse_);
  }
  levels_ = coarsen(first_level(diagonal));
  diagonal_ = std::move(diagonal[1]);
}

/// The network of 2×2 blocks, as `coarsen` makes it of a grid whose links are 1 between unknown pixels and
/// whose sinks count the held neighbours; the finest level is never stored in that form.
template <class Real>
Level<Real> Diffusion<Real>::first_level(const Board<Real>& diagonal) {
  Level<Real> first((width_ + 1) / 2, (height_ + 1) / 2);
  auto east = row_buffer(r_), south = east, sink = east;
  for (int y = 0; y < first.height; ++y) {
    const int top = 2 * y, bottom = top + 1, below = std::min(top + 2, height_);
    const auto& [red, black] = unknown_;
    const Neighbours<Real> of_black(red, 1, top), of_red(black, 0, bottom);
    Real* __restrict to_east = east.data();
    Real* __restrict to_south = south.data();
    Real* __restrict to_sink = sink.data();
    for (int k = 0; k < span_; ++k) {
      to_east[k] = (black.row(top)[k] * of_black.east[k] + red.row(bottom)[k] * of_red.east[k]) / 2;
      to_south[k] = (black.row(bottom)[k] * red.row(below)[k] + red.row(bottom)[k] * black.row(below)[k]) / 2;
      to_sink[k] = 0;
    }
    for (int row = top; row < std::min(top + 2, height_); ++row)
      for (int colour = 0; colour < 2; ++colour) {
        const auto c = static_cast<std::size_t>(colour);
        const Neighbours<Real> others(unknown_[1 - c], colour, row);
        const Real* unknown = unknown_[c].row(row);
        const Real* degree = diagonal[c].row(row);
        for (int k = 0; k < span_; ++k) {
          const Real held = degree[k] - unknown[k] * others.sum(k);
          to_sink[k] += held * sink_share(held);
        }
      }
    split_row(east.data(), y, first.east);
    split_row(south.data(), y, first.south);
    split_row(sink.data(), y, first.sink);
  }
  return first;
}

/// Unknown pixels of one colour become the mean of their neighbours.
template <class Real>
void Diffusion<Real>::average(Board<Real>& field, int colour) const {
  const auto c = static_cast<std::size_t>(colour);
  for (int y = 0; y < height_; ++y) {
    const Neighbours<Real> others(field[1 - c], colour, y);
    const Real* inverse = inverse_[c].row(y);
    const Real* unknown = unknown_[c].row(y);
    Real* __restrict f = field[c].row(y);
    for (int k = 0; k < span_; ++k) f[k] = (1 - unknown[k]) * f[k] + others.sum(k) * inverse[k];
  }
}

/// A first field from the coarse levels, and the residual of its black pixels.
template <class Real>
void Diffusion<Real>::begin(Board<Real>& field) {
  Level<Real>& first = levels_.front();
  for (int y = 0; y < first.height; ++y) {
    std::fill(cells_.begin(), cells_.end(), Real(0));
    Real* __restrict sum = cells_.data();
    for (int row = 2 * y; row < std::min(2 * y + 2, height_); ++row)
      for (int colour = 0; colour < 2; ++colour) {
        const auto c = static_cast<std::size_t>(colour);
        const Neighbours<Real> values(field[1 - c], colour, row), others(unknown_[1 - c], colour, row);
        const Real* unknown = unknown_[c].row(row);
        const Real* inverse = inverse_[c].row(row);
        for (int k = 0; k < span_; ++k) {
          const Real held = 1 / (inverse[k] + 1 - unknown[k]) - others.sum(k);
          sum[k] += unknown[k] * values.sum(k) * sink_share(unknown[k] * held);
        }
      }
    split_row(cells_.data(), y, first.b);
  }
  solve_roughly(levels_);
  for (int y = 0; y < height_; ++y) {
    lift(y);
    const Real* e = lane(y);
    Real* __restrict f = field[0].row(y);
    for (int k = 0; k < span_; ++k) f[k] += e[k];
  }
  average(field, 1);
  average(field, 0);
  for (int y = 0; y < height_; ++y) {
    const Neighbours<Real> reds(field[0], 1, y);
    const Real *unknown = unknown_[1].row(y), *diagonal = diagonal_.row(y), *f = field[1].row(y);
    Real* __restrict r = r_.row(y), * __restrict p = p_.row(y);
    for (int k = 0; k < span_; ++k) r[k] = unknown[k] * reds.sum(k) - diagonal[k] * f[k];
    std::fill(p, p + span_, Real(0));
  }
}

/// First half of a V-cycle: relaxes the black pixels from nothing and hands the red ones' residual down.
template <class Real>
void Diffusion<Real>::descend() {
  Level<Real>& first = levels_.front();
  const auto relax = [&](int y) {
    if (y >= height_) return;
    Real* __restrict z = z_.row(y);
    const Real *r = r_.row(y), *inverse = inverse_[1].row(y);
    for (int k = 0; k < span_; ++k) z[k] = r[k] * inverse[k];
  };
  relax(0);
  for (int y = 0; y < first.height; ++y) {
    relax(2 * y + 1);
    relax(2 * y + 2);
    std::fill(cells_.begin(), cells_.end(), Real(0));
    Real* __restrict sum = cells_.data();
    for (int row = 2 * y; row < std::min(2 * y + 2, height_); ++row) {
      const Neighbours<Real> blacks(z_, 0, row);
      const Real* unknown = unknown_[0].row(row);
      for (int k = 0; k < span_; ++k) sum[k] += unknown[k] * blacks.sum(k);
    }
    split_row(cells_.data(), y, first.b);
  }
}

/// Puts the blocks' solution into the red pixels of one row. Rows come in order.
template <class Real>
void Diffusion<Real>::lift(int y) {
  Real* __restrict e = lane(y);
  if (y < 0 || y >= height_) {
    std::fill(e, e + span_, Real(0));
    return;
  }
  if (y % 2 == 0) join_row(levels_.front().x, y / 2, cells_.data());
  const Real *unknown = unknown_[0].row(y), *blocks = cells_.data();
  for (int k = 0; k < span_; ++k) e[k] = unknown[k] * blocks[k];
}

/// Second half: the red pixels have the blocks' correction, the black ones are relaxed after them.
template <class Real>
typename Diffusion<Real>::Correction Diffusion<Real>::ascend() {
  Correction correction{0, 0};
  lift(-1);
  lift(0);
  for (int y = 0; y < height_; ++y) {
    lift(y + 1);
    const Neighbours<Real> reds(lane(y - 1), lane(y), lane(y + 1), 1, y);
    const Real *r = r_.row(y), *inverse = inverse_[1].row(y);
    Real* __restrict z = z_.row(y);
    for (int k = 0; k < span_; ++k) z[k] = (r[k] + reds.sum(k)) * inverse[k];
    correction.product += dot(r, z, span_);
    correction.largest = std::max(correction.largest, largest(z, span_));
  }
  return correction;
}

template <class Real>
typename Diffusion<Real>::Correction Diffusion<Real>::precondition() {
  descend();
  cycle(levels_);
  return ascend();
}

/// The red pixels of one row that p implies.
template <class Real>
void Diffusion<Real>::eliminate(int y) {
  Real* __restrict e = lane(y);
  if (y < 0 || y >= height_) {
    std::fill(e, e + span_, Real(0));
    return;
  }
  const Neighbours<Real> blacks(p_, 0, y);
  const Real* inverse = inverse_[0].row(y);
  for (int k = 0; k < span_; ++k) e[k] = blacks.sum(k) * inverse[k];
}

/// p = z + beta p and q = A p; returns p·q. One way through memory.
template <class Real>
double Diffusion<Real>::search(Real beta) {
  const auto step = [&](int y) {
    if (y >= height_) return;
    Real* __restrict p = p_.row(y);
    const Real* z = z_.row(y);
    for (int k = 0; k < span_; ++k) p[k] = z[k] + beta * p[k];
  };
  double product = 0;
  step(0);
  step(1);
  eliminate(-1);
  eliminate(0);
  for (int y = 0; y < height_; ++y) {
    step(y + 2);
    eliminate(y + 1);
    const Neighbours<Real> reds(lane(y - 1), lane(y), lane(y + 1), 1, y);
    const Real *p = p_.row(y), *diagonal = diagonal_.row(y), *unknown = unknown_[1].row(y);
    Real* __restrict q = q_.row(y);
    for (int k = 0; k < span_; ++k) q[k] = diagonal[k] * p[k] - unknown[k] * reds.sum(k);
    product += dot(p, q, span_);
  }
  return product;
}

template <class Real>
void Diffusion<Real>::advance(Board<Real>& field, Real alpha) {
  for (int y = 0; y < height_; ++y) {
    Real* __restrict f = field[1].row(y), * __restrict r = r_.row(y);
    const Real *p = p_.row(y), *q = q_.row(y);
    for (int k = 0; k < span_; ++k) {
      f[k] += alpha * p[k];
      r[k] -= alpha * q[k];
    }
  }
}

template <class Real>
typename Diffusion<Real>::Outcome Diffusion<Real>::solve(Board<Real>& field, double tolerance,
                                                         int max_iterations) {
  begin(field);
  Outcome outcome;
  // M is close to A, so M⁻¹r is the error within a small factor, whatever its shape. The residual alone
  // hardly measures the smooth error of a frame that is held at one corner only.
  Correction now = precondition();
  double beta = 0;
  while (now.largest > tolerance && outcome.iterations < max_iterations) {
    const double curvature = search(static_cast<Real>(beta));
    if (!(curvature > 0)) break;
    advance(field, static_cast<Real>(now.product / curvature));
    const double before = now.product;
    now = precondition();
    beta = now.product / before;
    ++outcome.iterations;
  }
  average(field, 0);
  outcome.error = now.largest;
  outcome.converged = now.largest <= tolerance;
  return outcome;
}

template class Diffusion<float>;
template class Diffusion<double>;

}  // namespace emberfold::sketch
