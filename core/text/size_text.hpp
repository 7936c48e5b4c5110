// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <opencv2/core/types.hpp>

namespace emberfold::core {

/// Returns "640x480".
inline std::string size_text(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

inline std::string size_text(cv::Size size) {
  return size_text(size.width, size.height);
}

}  // namespace emberfold::core
