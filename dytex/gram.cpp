// SPDX-License-Identifier: Apache-2.0
#include "dytex/gram.hpp"

#include <algorithm>
#include <cstdint>

#include <opencv2/core/hal/interface.h>
#include <opencv2/core/hal/intrin.hpp>

#include "core/parallel.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr std::size_t kTile = 48;  // frames: a tile of the matrix is kTile × kTile

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

/// Frames' bytes of a block widened to 16 bits, a row of kBlock for each frame and zeros behind them: then
/// one instruction sums pairs of products. The sum over a block stays below 2³¹: 256 · 255² < 2²⁴.
void widen(const FrameValues& values, std::size_t first, std::size_t last, std::size_t begin,
           std::vector<std::int16_t>& rows) {
  const std::size_t count = std::min(kBlock, values.count - begin);
  for (std::size_t i = first; i < last; ++i) {
    const std::uint8_t* from = static_cast<const std::uint8_t*>(values.frames[i]) + begin;
    std::int16_t* to = rows.data() + (i - first) * kBlock;
    std::size_t p = 0;
    for (; p + 8 <= count; p += 8) cv::v_store(to + p, cv::v_reinterpret_as_s16(cv::v_load_expand(from + p)));
    for (; p < count; ++p) to[p] = from[p];
    std::fill(to + count, to + kBlock, std::int16_t{0});
  }
}

/// sums[4 a + b] += Σ left_a right_b over a block. All twelve sums stay in registers.
constexpr std::size_t kLeft = 3, kRight = 4;

void add_dot_products(const std::int16_t* left, const std::int16_t* right, double* sums, std::size_t stride) {
  cv::v_int32x4 s00 = cv::v_setzero_s32(), s01 = s00, s02 = s00, s03 = s00, s10 = s00, s11 = s00, s12 = s00,
                s13 = s00, s20 = s00, s21 = s00, s22 = s00, s23 = s00;
  for (std::size_t p = 0; p < kBlock; p += 8) {
    const cv::v_int16x8 a0 = cv::v_load(left + p), a1 = cv::v_load(left + kBlock + p),
                        a2 = cv::v_load(left + 2 * kBlock + p);
    cv::v_int16x8 b = cv::v_load(right + p);
    s00 = cv::v_dotprod(a0, b, s00), s10 = cv::v_dotprod(a1, b, s10), s20 = cv::v_dotprod(a2, b, s20);
    b = cv::v_load(right + kBlock + p);
    s01 = cv::v_dotprod(a0, b, s01), s11 = cv::v_dotprod(a1, b, s11), s21 = cv::v_dotprod(a2, b, s21);
    b = cv::v_load(right + 2 * kBlock + p);
    s02 = cv::v_dotprod(a0, b, s02), s12 = cv::v_dotprod(a1, b, s12), s22 = cv::v_dotprod(a2, b, s22);
    b = cv::v_load(right + 3 * kBlock + p);
    s03 = cv::v_dotprod(a0, b, s03), s13 = cv::v_dotprod(a1, b, s13), s23 = cv::v_dotprod(a2, b, s23);
  }
  const auto add = [&](std::size_t column, const cv::v_int32x4& x, const cv::v_int32x4& y,
                       const cv::v_int32x4& z) {
    sums[column * stride] += cv::v_reduce_sum(x);
    sums[column * stride + 1] += cv::v_reduce_sum(y);
    sums[column * stride + 2] += cv::v_reduce_sum(z);
  };
  add(0, s00, s10, s20), add(1, s01, s11, s21), add(2, s02, s12, s22), add(3, s03, s13, s23);
}

void add_bytes(const FrameValues& values, const Tile& tile, Eigen::MatrixXd& gram,
               const core::Context& context) {
  std::vector<std::int16_t> left(kTile * kBlock), right(tile.diagonal() ? 0 : kTile * kBlock);
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(kTile, kTile);
  for (std::size_t begin = 0; begin < values.count && !context.cancelled(); begin += kBlock) {
    widen(values, tile.i0, tile.i1, begin, left);
    if (!tile.diagonal()) widen(values, tile.j0, tile.j1, begin, right);
    const std::int16_t* others = tile.diagonal() ? left.data() : right.data();
    for (std::size_t i = 0; i < tile.i1 - tile.i0; i += kLeft)
      for (std::size_t j = 0; j < tile.j1 - tile.j0 && (!tile.diagonal() || j < i + kLeft); j += kRight)
        add_dot_products(left.data() + i * kBlock, others + j * kBlock, sums.data() + j * kTile + i, kTile);
  }
  tile.part(gram) += sums.topLeftCorner(tile.rows(), tile.columns());
}

template <class Value>
void add_values(const FrameValues& values, const Tile& tile, Eigen::MatrixXd& gram,
                const core::Context& context) {
  const auto convert = [&](std::size_t first, std::size_t begin, Eigen::Index rows, Eigen::MatrixXd& to) {
    for (Eigen::Index k = 0; k < to.cols(); ++k) {
      const auto* from =
          static_cast<const Value*>(values.frames[first + static_cast<std::size_t>(k)]) + begin;
      to.col(k).head(rows) =
          Eigen::Map<const Eigen::Vector<Value, Eigen::Dynamic>>(from, rows).template cast<double>();
    }
  };
  Eigen::MatrixXd left(kBlock, tile.rows()), right(kBlock, tile.diagonal() ? 0 : tile.columns());
  for (std::size_t begin = 0; begin < values.count && !context.cancelled(); begin += kBlock) {
    const auto rows = static_cast<Eigen::Index>(std::min(kBlock, values.count - begin));
    convert(tile.i0, begin, rows, left);
    convert(tile.j0, begin, rows, right);
    const Eigen::MatrixXd& others = tile.diagonal() ? left : right;
    tile.part(gram).noalias() += left.topRows(rows).transpose() * others.topRows(rows);
  }
}

}  // namespace

core::Status add_gram(const FrameValues& values, Eigen::MatrixXd& gram, const core::Context& context) {
  const std::vector<Tile> tiles = tiles_of(values.frames.size());
  core::parallel_for(tiles.size(), context, [&](std::size_t i) {
    if (values.depth == CV_8U) return add_bytes(values, tiles[i], gram, context);
    if (values.depth == CV_16U) return add_values<std::uint16_t>(values, tiles[i], gram, context);
    add_values<float>(values, tiles[i], gram, context);
  });
  return context.cancelled() ? core::Status::cancelled : core::Status::done;
}

Eigen::MatrixXd centred(const Eigen::MatrixXd& gram) {
  Eigen::MatrixXd result = gram.selfadjointView<Eigen::Lower>();
  const Eigen::VectorXd means = result.rowwise().mean();
  const double mean = means.mean();
  result.colwise() -= means;
  result.rowwise() -= means.transpose();
  result.array() += mean;
  return result;
}

}  // namespace emberfold::dytex::detail
