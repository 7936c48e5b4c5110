// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace emberfold::apps {

/// A JPEG picture.
struct Still {
  std::vector<unsigned char> jpeg;
  int width = 0, height = 0;  ///< px, as encoded
};

/// Encodes a picture (CV_8UC1 or CV_8UC3) in at most `most_bytes` (≥ 4096).
/// Reduces it to `longest_side` px, then the quality, then the size, until it fits.
Still make_still(const cv::Mat& picture, int longest_side, std::size_t most_bytes);

/// Encodes bytes by RFC 4648, padded.
std::string base64(std::span<const unsigned char> bytes);

/// Writes a still as "data:image/jpeg;base64,…".
std::string data_uri(const Still& still);

/// Picks at most `count` of `numbers` (ascending) evenly, including the first and the last.
std::vector<int> spread_evenly(std::span<const int> numbers, std::size_t count);

}  // namespace emberfold::apps
