// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/model_archive.hpp"

namespace emberfold::apps {

/// CV_8U, any channels, as rows × columns × channels.
core::NpyArray byte_array(const cv::Mat& values);

/// A motion model's array of that shape; core::IoError, naming it, where it is missing or another.
const std::vector<std::uint8_t>& byte_array(const core::ModelArchive& archive, const std::string& name,
                                            cv::Size size, std::size_t channels);

}  // namespace emberfold::apps
