// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <opencv2/core/mat.hpp>

#include "core/io/tiff_pages.hpp"

namespace emberfold::io {

/// Reads a page without a head of its own (TiffPage::raw): CV_8U, CV_16U or CV_32F, 1 or 3 channels (blue,
/// green, red). Empty where its kind is another, or reading stops half way.
cv::Mat read_raw_page(const std::filesystem::path& path, const TiffPage& page);

}  // namespace emberfold::io
