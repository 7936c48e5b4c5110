// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/model_archive.hpp"

// What is kept beside a motion model's own arrays.
namespace emberfold::core {

/// CV_8U or CV_32F, any channels, as rows × columns × channels.
core::NpyArray byte_array(const cv::Mat& values);
core::NpyArray float_array(const cv::Mat& values);

/// A motion model's array of that size; core::IoError, naming it, where it is missing, another, or holds a
/// number that is not finite or beyond ±10⁶. One channel may go without its axis.
cv::Mat read_bytes(const core::ModelArchive& archive, const std::string& name, cv::Size size, int channels);
cv::Mat read_floats(const core::ModelArchive& archive, const std::string& name, cv::Size size, int channels);

/// 1 where the archive has this array and it has one channel, else 3.
int channels_of(const core::ModelArchive& archive, const std::string& name);

}  // namespace emberfold::core
