// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <memory>

#include <opencv2/core/mat.hpp>

#include "core/io/tiff_pages.hpp"

struct tiff;

namespace emberfold::io {

/// Reads pages of one TIFF file, in any order.
class PageReader {
 public:
  explicit PageReader(std::filesystem::path path);

  /// Returns a page of this file that read_picture_pages listed: CV_8U, CV_16U or CV_32F, 1 or 3 channels
  /// (blue, green, red); values as stored, but white is bright. Throws core::IoError that names file and
  /// page: its kind is not supported, or it cannot be decoded. Floats may be non-finite.
  cv::Mat read(const TiffPage& page);

 private:
  struct Close {
    void operator()(tiff* file) const;
  };

  std::filesystem::path path_;
  std::unique_ptr<tiff, Close> file_;
  std::ifstream bytes_;  ///< of pages without heads
};

/// Returns the pages that are pictures, the description in the first; warns of those that are not, and of
/// values with a special meaning. Throws core::IoError that names the file.
std::vector<TiffPage> read_picture_pages(const std::filesystem::path& path, const core::Warn& warn);

}  // namespace emberfold::io
