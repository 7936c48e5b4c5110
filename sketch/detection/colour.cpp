// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/colour.hpp"

namespace emberfold::sketch {

std::vector<cv::Mat1f> compute_opponent_colours(const cv::Mat& levels) {
  std::vector<cv::Mat1f> channels(2);
  for (std::size_t c = 0; c < 2; ++c) {
    const std::array<float, 3>& axis = kColourAxes[c + 1];
    channels[c].create(levels.size());
    for (int y = 0; y < levels.rows; ++y) {
      const auto* from = levels.ptr<cv::Vec3f>(y);
      float* to = channels[c][y];
      // Differences from green first: equal channels give 0, not what rounding leaves of it.
      for (int x = 0; x < levels.cols; ++x)
        to[x] = axis[0] * (from[x][0] - from[x][1]) + axis[2] * (from[x][2] - from[x][1]);
    }
  }
  return channels;
}

}  // namespace emberfold::sketch
