// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace emberfold::io {

/// Compares in natural order: runs of digits as numbers (img2 before img10), all else byte by byte.
bool natural_less(std::string_view a, std::string_view b);

/// Returns whether the name has the extension of a still image.
bool is_image_name(const std::filesystem::path& path);

/// A printf number at the start of a pattern.
struct PatternNumber {
  std::size_t length = 0;  ///< characters of the pattern
  std::size_t digits = 0;  ///< minimum printed; 0: not padded with zeros
};

/// Returns the number that a pattern begins with, %d or %0Nd with N below 100; nothing where it does not.
std::optional<PatternNumber> pattern_number(std::string_view pattern);

/// Returns whether the last part of the name holds `*`, `?` or a printf number such as %04d.
bool is_pattern(const std::filesystem::path& path);

/// Returns whether a file name fits a pattern: `*` any run, `?` any one byte, `%d` a number without leading
/// zeros, `%0Nd` a number padded to N digits, `%%` a percent sign.
bool fits_pattern(std::string_view pattern, std::string_view name);

/// Lists the images of a folder, or the files that fit a pattern's last part, in natural order. Skips hidden
/// files. Throws core::IoError where the folder cannot be read or no file is left.
std::vector<std::filesystem::path> list_images(const std::filesystem::path& folder);
std::vector<std::filesystem::path> match_images(const std::filesystem::path& pattern);

/// One image: CV_8U, CV_16U or CV_32F (TIFF), 1 or 3 channels, upright by its EXIF or TIFF orientation.
struct ImageFile {
  cv::Mat pixels;
  int pages = 1;                        ///< in the file; the first one was read
  std::vector<std::string> notes = {};  ///< on values that are not plain: alpha, palettes
};

/// Reads one image; `channel`: of a TIFF whose samples are separate channels, none: the first. Throws
/// core::IoError, naming the file: it cannot be opened, is not an image, is cut off or damaged (found for
/// PNG, JPEG and TIFF), or holds another depth; core::InputError: no such channel.
ImageFile read_image(const std::filesystem::path& path, std::optional<int> channel = {});

}  // namespace emberfold::io
