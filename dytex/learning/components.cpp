// SPDX-License-Identifier: Apache-2.0
#include "dytex/learning/components.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>

#include <opencv2/core/hal/interface.h>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "dytex/learning/decompositions.hpp"
#include "dytex/learning/kernels.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr std::size_t kRows = 512;           // values of a block of C
constexpr std::size_t kSlabs = 16;           // parts in which CᵀC is summed
constexpr std::size_t kBytesIn16Bits = 257;  // frames whose bytes add up within 16 bits: 257 · 255 < 2¹⁶
static_assert(kRows % kSlice == 0);

/// Calls body(first, count) for blocks of [0, count).
void for_blocks(std::size_t count, const core::Context& context,
                const std::function<void(std::size_t, std::size_t)>& body) {
  core::parallel_for((count + kRows - 1) / kRows, context,
                     [&](std::size_t i) { body(i * kRows, std::min(kRows, count - i * kRows)); });
}

template <class Body>
void with_depth(int depth, const Body& body) {
  if (depth == CV_8U) return body(std::uint8_t{});
  if (depth == CV_16U) return body(std::uint16_t{});
  body(float{});
}

void add_byte_sums(const FrameValues& values, std::size_t begin, std::size_t count, double* sums) {
  for (std::size_t t0 = 0; t0 < values.frames.size(); t0 += kBytesIn16Bits) {
    std::array<std::uint16_t, kRows> some{};
    for (std::size_t t = t0; t < std::min(t0 + kBytesIn16Bits, values.frames.size()); ++t) {
      const std::uint8_t* from = values.frame<std::uint8_t>(t) + begin;
      for (std::size_t p = 0; p < count; ++p) some[p] = static_cast<std::uint16_t>(some[p] + from[p]);
    }
    for (std::size_t p = 0; p < count; ++p) sums[p] += some[p];
  }
}

/// Columns, filled up to whole panels.
std::size_t whole_panels(std::size_t columns) {
  return (columns + kPanel - 1) / kPanel * kPanel;
}

/// A block of C and its factors, in slices.
struct Work {
  std::vector<float> left, out, mean;
  Work(std::size_t depth, std::size_t columns)
      : left(kRows * depth), out(kRows * whole_panels(columns)), mean(kRows) {}
};

/// Slices of kSlice rows; those after the last row are 0.
std::size_t slice_count(std::size_t rows) {
  return (rows + kSlice - 1) / kSlice;
}

template <class Value>
void centre(const Value* from, std::size_t rows, const float* mean, float* to, std::size_t step) {
  for (std::size_t i = 0; i < rows; i += kSlice, to += step) {
    if (i + kSlice <= rows) {
      for (std::size_t k = 0; k < kSlice; ++k) to[k] = static_cast<float>(from[i + k]) - mean[i + k];
    } else {
      for (std::size_t k = 0; k < rows - i; ++k) to[k] = static_cast<float>(from[i + k]) - mean[i + k];
      std::fill(to + (rows - i), to + kSlice, 0.0F);
    }
  }
}

/// Packs right factors in panels: see add_product().
std::vector<float> pack_panels(const Eigen::MatrixXd& right) {
  const auto depth = static_cast<std::size_t>(right.rows()), columns = static_cast<std::size_t>(right.cols());
  std::vector<float> result(whole_panels(columns) * depth, 0);
  for (std::size_t j = 0; j < columns; ++j)
    for (std::size_t t = 0; t < depth; ++t)
      result[(j / kPanel * depth + t) * kPanel + j % kPanel] =
          static_cast<float>(right(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(j)));
  return result;
}

template <class Value>
void add_block(const FrameValues& values, std::size_t begin, std::size_t rows, std::size_t row,
               const Eigen::VectorXd& mean, const std::vector<std::vector<float>>& batches,
               Eigen::MatrixXf& C) {
  const auto n = static_cast<std::size_t>(C.cols());
  const Isa isa = best_isa();
  Work work(std::min(kBatch, values.frames.size()), n);
  const auto first = static_cast<Eigen::Index>(row), count = static_cast<Eigen::Index>(rows);
  Eigen::Map<Eigen::MatrixXf> out(work.out.data(), kRows, C.cols());
  out.topRows(count) = C.middleRows(first, count);
  Eigen::Map<Eigen::VectorXf>(work.mean.data(), count) = mean.segment(first, count).cast<float>();
  for (std::size_t b = 0; b < batches.size(); ++b) {
    const std::size_t t0 = b * kBatch, depth = std::min(kBatch, values.frames.size() - t0);
    for (std::size_t t = 0; t < depth; ++t)
      centre(values.frame<Value>(t0 + t) + begin, rows, work.mean.data(), work.left.data() + t * kSlice,
             depth * kSlice);
    add_product(isa, {work.left.data(), slice_count(rows), depth}, batches[b].data(), n, work.out.data(),
                kRows);
  }
  C.middleRows(first, count) = out.topRows(count);
}

/// Calls body(slab, block of C in slices, its first row, its rows); blocks of a slab one after another.
void for_slices(const Eigen::MatrixXf& C, const core::Context& context,
                const std::function<void(std::size_t, const Slices&, Eigen::Index, Eigen::Index)>& body) {
  const auto m = static_cast<std::size_t>(C.rows()), n = static_cast<std::size_t>(C.cols());
  const std::size_t blocks = (m + kRows - 1) / kRows;
  core::parallel_for(kSlabs, context, [&](std::size_t slab) {
    std::vector<float> left(kRows * n);
    for (std::size_t b = blocks * slab / kSlabs; b < blocks * (slab + 1) / kSlabs; ++b) {
      context.check();
      const std::size_t rows = std::min(kRows, m - b * kRows);
      for (std::size_t j = 0; j < n; ++j) {
        const float* from = C.data() + j * m + b * kRows;
        for (std::size_t i = 0; i < rows; i += kSlice) {
          float* to = left.data() + (i / kSlice * n + j) * kSlice;
          const std::size_t some = std::min(kSlice, rows - i);
          std::copy_n(from + i, some, to);
          std::fill(to + some, to + kSlice, 0.0F);
        }
      }
      body(slab, {left.data(), slice_count(rows), n}, static_cast<Eigen::Index>(b * kRows),
           static_cast<Eigen::Index>(rows));
    }
  });
}

}  // namespace

void add_sums(const FrameValues& values, std::size_t first, Eigen::VectorXd& sums,
              const core::Context& context) {
  for_blocks(values.count, context, [&](std::size_t begin, std::size_t count) {
    double* to = sums.data() + first + begin;
    if (values.depth == CV_8U) return add_byte_sums(values, begin, count, to);
    with_depth(values.depth, [&]<class Value>(Value) {
      for (std::size_t t = 0; t < values.frames.size(); ++t) {
        const Value* from = values.frame<Value>(t) + begin;
        for (std::size_t p = 0; p < count; ++p) to[p] += static_cast<double>(from[p]);
      }
    });
  });
}

void add_components(const FrameValues& values, std::size_t first, const Eigen::VectorXd& mean,
                    const Eigen::MatrixXd& weights, Eigen::MatrixXf& C, const core::Context& context) {
  std::vector<std::vector<float>> batches;
  for (Eigen::Index t = 0; t < weights.rows(); t += kBatch)
    batches.push_back(pack_panels(weights.middleRows(t, std::min<Eigen::Index>(kBatch, weights.rows() - t))));
  for_blocks(values.count, context, [&](std::size_t begin, std::size_t rows) {
    with_depth(values.depth, [&]<class Value>(Value) {
      add_block<Value>(values, begin, rows, first + begin, mean, batches, C);
    });
  });
}

void make_components(const FrameValues& values, std::size_t first, const Eigen::VectorXd& mean,
                     const Eigen::MatrixXd& weights, Eigen::MatrixXf& C, const core::Context& context) {
  for_blocks(values.count, context, [&](std::size_t begin, std::size_t count) {
    const auto row = static_cast<Eigen::Index>(first + begin), rows = static_cast<Eigen::Index>(count);
    Eigen::MatrixXd block(rows, weights.rows());
    with_depth(values.depth, [&]<class Value>(Value) {
      for (Eigen::Index t = 0; t < block.cols(); ++t) {
        const Value* from = values.frame<Value>(static_cast<std::size_t>(t)) + begin;
        block.col(t) =
            Eigen::Map<const Eigen::Vector<Value, Eigen::Dynamic>>(from, rows).template cast<double>() -
            mean.segment(row, rows);
      }
    });
    C.middleRows(row, rows) = (block * weights).cast<float>();
  });
}

void orthonormalise(Eigen::MatrixXf& C, const core::Context& context) {
  const Eigen::Index n = C.cols();
  if (n == 0) return;
  const Isa isa = best_isa();
  std::vector<Eigen::MatrixXd> parts(kSlabs, Eigen::MatrixXd::Zero(n, n));
  for_slices(C, context, [&](std::size_t slab, const Slices& block, Eigen::Index, Eigen::Index) {
    add_inner_products(isa, block, parts[slab].data());
  });
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(n, n);
  for (const Eigen::MatrixXd& part : parts) products += part;
  const CholeskyFactors factors(products);  // reads the lower half
  context.check();
  if (!factors.positive()) throw core::NumericalError("learn: the components are not independent");
  const std::vector<float> right =
      pack_panels(factors.solve_lower(Eigen::MatrixXd::Identity(n, n)).transpose());
  for_slices(C, context, [&](std::size_t, const Slices& block, Eigen::Index row, Eigen::Index rows) {
    Eigen::MatrixXf out =
        Eigen::MatrixXf::Zero(kRows, static_cast<Eigen::Index>(whole_panels(static_cast<std::size_t>(n))));
    add_product(isa, block, right.data(), static_cast<std::size_t>(n), out.data(), kRows);
    C.middleRows(row, rows) = out.topLeftCorner(rows, n);
  });
}

}  // namespace emberfold::dytex::detail
