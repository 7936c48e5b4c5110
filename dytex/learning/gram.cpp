// SPDX-License-Identifier: Apache-2.0
#include "dytex/learning/gram.hpp"

#include <algorithm>
#include <cstdint>
#include <mutex>

#include <opencv2/core/cvdef.h>
#include <opencv2/core/hal/interface.h>

#include "core/parallel.hpp"
#include "dytex/learning/kernels.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr std::size_t kTile = 48;   // frames: a tile of the matrix is kTile × kTile
constexpr std::size_t kTasks = 64;  // at least, where values are many: enough for all threads

/// A tile on or below the diagonal: frames [i0, i1) × [j0, j1).
struct Tile {
  std::size_t i0, i1, j0, j1;
  [[nodiscard]] bool diagonal() const { return i0 == j0; }
  [[nodiscard]] Eigen::Index rows() const { return static_cast<Eigen::Index>(i1 - i0); }
  [[nodiscard]] Eigen::Index columns() const { return static_cast<Eigen::Index>(j1 - j0); }
  [[nodiscard]] auto part(Eigen::MatrixXd& gram) const {
    return gram.block(static_cast<Eigen::Index>(i0), static_cast<Eigen::Index>(j0), rows(), columns());
  }
};

std::vector<Tile> tiles_of(std::size_t frames) {
  std::vector<Tile> tiles;
  for (std::size_t i = 0; i < frames; i += kTile)
    for (std::size_t j = 0; j <= i; j += kTile)
      tiles.push_back({i, std::min(i + kTile, frames), j, std::min(j + kTile, frames)});
  return tiles;
}

/// Widens a block's bytes of frames to 16 bits, a row of kDotLength for each frame with zeros at the end.
void widen(const FrameValues& values, std::size_t first, std::size_t last, std::size_t begin,
           std::vector<std::int16_t>& rows) {
  const std::size_t count = std::min(kDotLength, values.count - begin);
  for (std::size_t i = first; i < last; ++i) {
    const std::uint8_t* from = values.frame<std::uint8_t>(i) + begin;
    std::int16_t* to = rows.data() + (i - first) * kDotLength;
    std::fill(std::copy_n(from, count, to), to + kDotLength, std::int16_t{0});
  }
}

/// Returns the part of a tile that comes from the values from `begin` to `end`.
Eigen::MatrixXd byte_products(const FrameValues& values, const Tile& tile, std::size_t begin, std::size_t end,
                              const core::Context& context) {
  const Isa isa = best_isa();
  std::vector<std::int16_t> left(kTile * kDotLength), right(tile.diagonal() ? 0 : kTile * kDotLength);
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(kTile, kTile);
  for (; begin < end; begin += kDotLength) {
    context.check();
    widen(values, tile.i0, tile.i1, begin, left);
    if (!tile.diagonal()) widen(values, tile.j0, tile.j1, begin, right);
    const std::int16_t* others = tile.diagonal() ? left.data() : right.data();
    for (std::size_t i = 0; i < tile.i1 - tile.i0; i += kDotLeft)
      for (std::size_t j = 0; j < tile.j1 - tile.j0 && (!tile.diagonal() || j < i + kDotLeft); j += kDotRight)
        add_dot_products(isa, left.data() + i * kDotLength, others + j * kDotLength,
                         sums.data() + j * kTile + i, kTile);
  }
  return sums.topLeftCorner(tile.rows(), tile.columns());
}

/// Sums of whole numbers are exact, so that parts may be added as they come.
void add_bytes(const FrameValues& values, Eigen::MatrixXd& gram, const core::Context& context) {
  const std::vector<Tile> tiles = tiles_of(values.frames.size());
  const std::size_t blocks = (values.count + kDotLength - 1) / kDotLength,
                    slabs = std::clamp<std::size_t>(kTasks / tiles.size(), 1, blocks);
  std::mutex adding;
  core::parallel_for(tiles.size() * slabs, context, [&](std::size_t task) {
    const Tile& tile = tiles[task / slabs];
    const std::size_t slab = task % slabs;
    const Eigen::MatrixXd part =
        byte_products(values, tile, blocks * slab / slabs * kDotLength,
                      std::min(blocks * (slab + 1) / slabs * kDotLength, values.count), context);
    const std::scoped_lock lock(adding);
    tile.part(gram) += part;
  });
}

template <class Value>
void add_values(const FrameValues& values, const Tile& tile, Eigen::MatrixXd& gram,
                const core::Context& context) {
  const auto convert = [&](std::size_t first, std::size_t begin, Eigen::Index rows, Eigen::MatrixXd& to) {
    for (Eigen::Index k = 0; k < to.cols(); ++k) {
      const Value* from = values.frame<Value>(first + static_cast<std::size_t>(k)) + begin;
      to.col(k).head(rows) =
          Eigen::Map<const Eigen::Vector<Value, Eigen::Dynamic>>(from, rows).template cast<double>();
    }
  };
  Eigen::MatrixXd left(kBlock, tile.rows()), right(kBlock, tile.diagonal() ? 0 : tile.columns());
  for (std::size_t begin = 0; begin < values.count; begin += kBlock) {
    context.check();
    const auto rows = static_cast<Eigen::Index>(std::min(kBlock, values.count - begin));
    convert(tile.i0, begin, rows, left);
    convert(tile.j0, begin, rows, right);
    const Eigen::MatrixXd& others = tile.diagonal() ? left : right;
    tile.part(gram).noalias() += left.topRows(rows).transpose() * others.topRows(rows);
  }
}

}  // namespace

void add_gram(const FrameValues& values, Eigen::MatrixXd& gram, const core::Context& context) {
  if (values.count == 0) return;
  if (values.depth == CV_8U) {
    add_bytes(values, gram, context);
  } else {
    const std::vector<Tile> tiles = tiles_of(values.frames.size());
    core::parallel_for(tiles.size(), context, [&](std::size_t i) {
      if (values.depth == CV_16U) return add_values<std::uint16_t>(values, tiles[i], gram, context);
      add_values<float>(values, tiles[i], gram, context);
    });
  }
}

Eigen::MatrixXd centred(const Eigen::MatrixXd& gram) {
  return centred(gram, gram.rows());
}

Eigen::MatrixXd centred(const Eigen::MatrixXd& gram, Eigen::Index first) {
  Eigen::MatrixXd result = gram.selfadjointView<Eigen::Lower>();
  const Eigen::VectorXd means = result.leftCols(first).rowwise().mean();
  const double mean = means.head(first).mean();
  result.colwise() -= means;
  result.rowwise() -= means.transpose();
  result.array() += mean;
  return result;
}

}  // namespace emberfold::dytex::detail
