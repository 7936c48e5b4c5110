// SPDX-License-Identifier: Apache-2.0
#include "apps/pictures/quilt_picture.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace emberfold::apps {

cv::Mat draw_quilt_map(const dytex::QuiltMap& map, std::span<const cv::Size> sources) {
  cv::Mat picture(map.size, CV_8UC3, cv::Scalar::all(0));
  for (int y = 0; y < map.size.height; ++y)
    for (int x = 0; x < map.size.width; ++x) {
      const auto& from = map.at(x, y);
      if (from.source < 0) continue;
      const cv::Size size = sources[static_cast<std::size_t>(from.source)];
      const double across = static_cast<double>(from.x) / size.width,
                   down = static_cast<double>(from.y) / size.height;
      picture.at<cv::Vec3b>(y, x) = {cv::saturate_cast<unsigned char>(170 * across),
                                     cv::saturate_cast<unsigned char>(from.source % 2 == 0 ? 200 : 110),
                                     cv::saturate_cast<unsigned char>(255 - 190 * down)};
    }
  cv::cvtColor(picture, picture, cv::COLOR_HSV2BGR);
  return picture;
}

cv::Mat draw_seams(const cv::Mat& frame, const dytex::QuiltMap& map) {
  const cv::Vec3b ink(60, 220, 255);
  cv::Mat picture = frame * 0.6;
  for (int y = 0; y < map.size.height; ++y)
    for (int x = 0; x < map.size.width; ++x) {
      const bool right = x + 1 < map.size.width && !dytex::continues(map.at(x, y), map.at(x + 1, y), {1, 0});
      const bool below = y + 1 < map.size.height && !dytex::continues(map.at(x, y), map.at(x, y + 1), {0, 1});
      if (right || below) picture.at<cv::Vec3b>(y, x) = ink;
    }
  return picture;
}

}  // namespace emberfold::apps
