// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace emberfold::apps {

/// A picture as JPEG.
struct Still {
  std::vector<unsigned char> jpeg;
  int width = 0, height = 0;  ///< px, as encoded
};

/// Encodes a picture (CV_8UC1 or CV_8UC3) in at most `most_bytes` (≥ 4096): first reduced to `longest_side`
/// px, then coarser, then smaller until it fits.
Still make_still(const cv::Mat& picture, int longest_side, std::size_t most_bytes);

/// RFC 4648, padded.
std::string base64(std::span<const unsigned char> bytes);

/// data:image/jpeg;base64,…
std::string data_uri(const Still& still);

/// At most `count` of `numbers` (ascending), spread evenly, the first and the last among them.
std::vector<int> spread(std::span<const int> numbers, std::size_t count);

}  // namespace emberfold::apps
