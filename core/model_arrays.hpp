// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/model_archive.hpp"

// Images as arrays of a model folder.
namespace emberfold::core {

/// Converts an image (CV_8U, any channels) to an array, rows × columns × channels.
core::NpyArray byte_array(const cv::Mat& values);
/// Converts an image (CV_32F, any channels) to an array, rows × columns × channels.
core::NpyArray float_array(const cv::Mat& values);

/// Reads an array as an image, CV_8U; the axis of a single channel may be missing.
/// Throws IoError, naming the array, if it is missing or of another type or shape.
cv::Mat read_bytes(const core::ModelArchive& archive, const std::string& name, cv::Size size, int channels);
/// Reads an array as an image, CV_32F; also refuses numbers that are not finite or beyond ±10⁶.
cv::Mat read_floats(const core::ModelArchive& archive, const std::string& name, cv::Size size, int channels);

/// Returns 1 if the archive has this array with one channel, else 3.
int channels_of(const core::ModelArchive& archive, const std::string& name);

}  // namespace emberfold::core
