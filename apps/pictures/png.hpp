// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

#include "core/io/files.hpp"
#include "core/io/staged_output.hpp"

namespace emberfold::apps {

/// Writes a picture as PNG into a folder of results. Throws core::IoError.
void write_png(io::OutputFolder& output, const std::string& name, const cv::Mat& picture);
/// Writes a picture as PNG into a staged file, and commits it. Throws core::IoError.
void write_png(io::StagedFile& file, const cv::Mat& picture);

}  // namespace emberfold::apps
