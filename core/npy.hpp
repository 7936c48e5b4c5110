// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <span>
#include <variant>
#include <vector>

namespace emberfold::core {

/// A number of 16 bits, IEEE 754 binary16: some three decimal digits, up to 65504. Kept as its bits; equal
/// are the same bits.
struct Half {
  std::uint16_t bits = 0;
  bool operator==(const Half&) const = default;
};

/// The nearest Half, of two equally near the even one; beyond 65520 infinite. A NaN stays one.
Half to_half(float value);
/// Exact.
float to_float(Half half);

/// An n-dimensional array as NumPy's .npy files hold it. `data` lies in the order that `fortran_order` tells:
/// last index fastest (false, C) or first index fastest (true, Fortran; a column-major matrix).
struct NpyArray {
  using Data = std::variant<std::vector<float>, std::vector<double>, std::vector<std::uint8_t>,
                            std::vector<std::uint16_t>, std::vector<std::int32_t>, std::vector<std::int64_t>,
                            std::vector<Half>>;
  std::vector<std::size_t> shape;  ///< may be empty: one number
  bool fortran_order = false;
  Data data;

  bool operator==(const NpyArray&) const = default;
};

/// An array that lies elsewhere, in the order that NpyArray tells.
struct NpyView {
  using Data = std::variant<std::span<const float>, std::span<const double>, std::span<const std::uint8_t>,
                            std::span<const std::uint16_t>, std::span<const std::int32_t>,
                            std::span<const std::int64_t>, std::span<const Half>>;
  std::vector<std::size_t> shape;
  bool fortran_order = false;
  Data data;
};
NpyView view(const NpyArray& array);

/// Reads one array: format versions 1 to 3, little- or big-endian f2, f4, f8, u1, u2, i4, i8. The length
/// promised by the header is held against `size_limit` bytes and against what the stream holds before memory
/// is taken; a stream that ends early or holds anything else is an IoError. Leaves the stream behind the
/// array.
NpyArray read_npy(std::istream& in, std::size_t size_limit = std::size_t{1} << 36);

/// Writes version 1.0, little-endian, the data beginning at a multiple of 64 bytes, as NumPy does. Throws
/// InputError where shape and data disagree, IoError where the stream fails.
void write_npy(std::ostream& out, const NpyArray& array);
void write_npy_view(std::ostream& out, const NpyView& array);

}  // namespace emberfold::core
