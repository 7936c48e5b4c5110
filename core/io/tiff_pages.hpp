// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace emberfold::io {

/// The head of one page of a TIFF file.
struct TiffPage {
  int index = 0;                        ///< in the file's chain of pages, from 0
  std::uint64_t width = 0, height = 0;  ///< px
  std::uint64_t bits = 1, samples = 1;  ///< a value; values a pixel
  std::uint64_t format = 1;             ///< 1: whole numbers, 2: signed ones, 3: floating point
  std::uint64_t compression = 1;        ///< 1: none
  std::uint64_t stored_bytes = 0;       ///< of its strips or tiles
  std::uint64_t subfile = 0;            ///< bit 0: a smaller copy of another page, bit 2: a mask
  std::uint64_t offset = 0;             ///< where its first strip or tile lies in the file
  bool little_endian = true;            ///< order of the bytes of its values
  bool raw = false;          ///< it has no head of its own: its pixels lie at `offset`, row after row
  std::string description;   ///< of the first page alone
  double pixels_a_unit = 0;  ///< across, of the file's unit of length; 0: not told
  double aspect = 1;         ///< of a pixel: width to height
  [[nodiscard]] bool is_picture() const { return (subfile & 5U) == 0; }
};

/// Returns whether the file begins as a TIFF (classic or BigTIFF, either byte order).
bool is_tiff(const std::filesystem::path& path);

/// Reads the heads of all pages in their order; at least one. The pages of a large ImageJ stack, of which
/// only the first has a head, are listed too. Checks that heads and pixels lie inside the file. Reads no
/// pixels. Throws core::IoError that names the file: it cannot be read, is cut off or damaged.
std::vector<TiffPage> read_tiff_pages(const std::filesystem::path& path);

}  // namespace emberfold::io
