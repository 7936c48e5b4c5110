// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
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
  [[nodiscard]] bool is_picture() const { return (subfile & 5U) == 0; }
};

/// Returns whether the file begins as a TIFF (classic or BigTIFF, either byte order).
bool is_tiff(const std::filesystem::path& path);

/// Reads the heads of all pages in their order; at least one. Checks that heads and pixels lie inside the
/// file. Reads no pixels. Throws core::IoError that names the file: it cannot be read, is cut off or damaged.
std::vector<TiffPage> read_tiff_pages(const std::filesystem::path& path);

}  // namespace emberfold::io
