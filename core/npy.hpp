// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <span>
#include <variant>
#include <vector>

namespace emberfold::core {

/// A number of 16 bits, IEEE 754 binary16: about three decimal digits, up to 65504.
/// Equality compares bits.
struct Half {
  std::uint16_t bits = 0;
  bool operator==(const Half&) const = default;
};

/// Rounds to the nearest Half, ties to even. From 65520 on the result is infinite; a NaN stays one.
Half to_half(float value);
/// Converts exactly.
float to_float(Half half);

/// An n-dimensional array of a NumPy .npy file.
/// `fortran_order`: false: the last index of `data` runs fastest (C); true: the first one (a column-major
/// matrix).
struct NpyArray {
  using Data = std::variant<std::vector<float>, std::vector<double>, std::vector<std::uint8_t>,
                            std::vector<std::uint16_t>, std::vector<std::int32_t>, std::vector<std::int64_t>,
                            std::vector<Half>>;
  std::vector<std::size_t> shape;  ///< empty for a single number
  bool fortran_order = false;
  Data data;

  bool operator==(const NpyArray&) const = default;
};

/// A view of an array in memory owned elsewhere; fields as in NpyArray.
struct NpyView {
  using Data = std::variant<std::span<const float>, std::span<const double>, std::span<const std::uint8_t>,
                            std::span<const std::uint16_t>, std::span<const std::int32_t>,
                            std::span<const std::int64_t>, std::span<const Half>>;
  std::vector<std::size_t> shape;
  bool fortran_order = false;
  Data data;
};
/// Returns a view of an array, which must outlive it.
NpyView view(const NpyArray& array);

/// Reads one array: format versions 1 to 3, little- or big-endian f2, f4, f8, u1, u2, i4, i8.
/// The header's length is checked against `size_limit` bytes and the length of the stream before memory is
/// taken. Throws IoError for a stream that ends early or has other content. Leaves the stream after the
/// array.
NpyArray read_npy(std::istream& in, std::size_t size_limit = std::size_t{1} << 36);

/// Writes version 1.0, little-endian, with the data at a multiple of 64 bytes, as NumPy does.
/// Throws InputError if shape and data disagree, IoError if the stream fails.
void write_npy(std::ostream& out, const NpyArray& array);
/// Writes a view; otherwise as write_npy.
void write_npy_view(std::ostream& out, const NpyView& array);

}  // namespace emberfold::core
