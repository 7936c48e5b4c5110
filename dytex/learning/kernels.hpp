// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

/// The innermost loops of learning, compiled for several instruction sets; the best that the machine has is
/// selected at run time.
namespace emberfold::dytex::detail {

enum class Isa { baseline, avx2, avx512 };  ///< avx2: with FMA; avx512: F and BW

/// Returns the best instruction set that both this machine and this build have.
Isa best_isa();

/// Length of the rows of add_dot_products(): a multiple of 32, with sums below 2³¹ in any order.
constexpr std::size_t kDotLength = 1024;
constexpr std::size_t kDotLeft = 3, kDotRight = 4;

/// Adds dot products: sums[b · stride + a] += Σ left_a right_b for the 3 rows of `left` and the 4 of `right`,
/// of values 0…255.
/// In whole numbers, and so the same with every instruction set.
void add_dot_products(Isa isa, const std::int16_t* left, const std::int16_t* right, double* sums,
                      std::size_t stride);

/// Rows of a slice.
constexpr std::size_t kSlice = 32;
/// Columns of a right factor that are processed together.
constexpr std::size_t kPanel = 6;

/// A matrix whose entry (i, j) is at data[(i / kSlice · columns + j) · kSlice + i % kSlice].
struct Slices {
  const float* data;
  std::size_t count, columns;
};

/// Adds a matrix product: out += left · right. out is (count · kSlice) × columns, entry (i, j) at out[j ·
/// stride + i], with room for whole panels of columns; right left.columns × columns, entry (t, j) at
/// panels[(j / kPanel · left.columns + t) · kPanel + j % kPanel]. Each sum takes one term after the other:
/// the same bytes with avx2 and avx512, which round once a term (FMA); the baseline rounds twice and differs
/// in the last bits.
void add_product(Isa isa, const Slices& left, const float* panels, std::size_t columns, float* out,
                 std::size_t stride);

/// Adds a Gram matrix: products[j · columns + i] += Σ block_i block_j over all rows, for i ≥ j. Rounding as
/// in add_product().
void add_inner_products(Isa isa, const Slices& block, double* products);

}  // namespace emberfold::dytex::detail
