// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/context.hpp"

namespace emberfold::io {

/// The head of one page of a TIFF file.
struct TiffPage {
  int index = 0;                        ///< in the list of pages, from 0
  std::uint64_t width = 0, height = 0;  ///< px
  std::uint64_t bits = 1, samples = 1;  ///< bits a value; values a pixel
  std::uint64_t format = 1;             ///< 1: whole numbers, 2: signed ones, 3: floating point
  std::uint64_t compression = 1;        ///< 1: none
  std::uint64_t photometric = 1;     ///< 0: grey, white is 0; 1: grey; 2: RGB; 3: palette; others: TIFF 6.0
  std::uint64_t orientation = 1;     ///< 1: rows from the top, columns from the left
  std::uint64_t planes = 1;          ///< 2: one sample of all pixels after the other
  std::uint64_t stored_bytes = 0;    ///< of its strips or tiles
  std::uint64_t subfile = 0;         ///< bit 0: a smaller copy of another page, bit 2: a mask
  std::uint64_t head = 0;            ///< position of its head in the file
  std::uint64_t offset = 0;          ///< position of its first strip or tile
  std::uint64_t stacked = 1;         ///< pictures of a MetaMorph stack, which has one head
  std::vector<double> times;         ///< of these pictures, s; empty: unknown
  std::vector<std::uint64_t> extra;  ///< of the last samples: 1, 2: alpha, 0: unknown
  std::optional<int> sample;         ///< the only one to be read; none: all that make the picture
  std::optional<double> white;       ///< where 0 is white: value that becomes 0; none: the bits' maximum, 1
  bool little_endian = true;         ///< order of the bytes of its values
  bool raw = false;                  ///< it has no head of its own: its pixels are at `offset`, row after row
  std::string description;           ///< of the first page alone
  double pixels_a_unit = 0;          ///< across, of the file's unit of length; 0: unknown
  double aspect = 1;                 ///< of a pixel: width to height
  [[nodiscard]] bool is_picture() const { return (subfile & 5U) == 0; }
};

/// Returns whether the file begins as a TIFF (classic or BigTIFF, either byte order).
bool is_tiff(const std::filesystem::path& path);

/// Reads the heads of all pages in their order; at least one. Also lists pages without heads: those of large
/// ImageJ stacks and of MetaMorph stacks, and planes that the head lists as pages. Warns where the file ends
/// early, and leaves out incomplete pages. Reads no pixels. Throws core::IoError that names the file: it
/// cannot be read, holds no whole page or is damaged.
std::vector<TiffPage> read_tiff_pages(const std::filesystem::path& path, const core::Warn& warn = {});

}  // namespace emberfold::io
