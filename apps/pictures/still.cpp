// SPDX-License-Identifier: Apache-2.0
#include "apps/pictures/still.hpp"

#include <algorithm>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace emberfold::apps {

Still make_still(const cv::Mat& picture, int longest_side, std::size_t most_bytes) {
  double scale = std::min(1.0, double(longest_side) / std::max(picture.cols, picture.rows));
  Still still;
  while (true) {
    cv::Mat small = picture;
    if (scale < 1) {
      const cv::Size size(std::max(1, cvRound(picture.cols * scale)),
                          std::max(1, cvRound(picture.rows * scale)));
      cv::resize(picture, small, size, 0, 0, cv::INTER_AREA);
    }
    still.width = small.cols, still.height = small.rows;
    for (const int quality : {84, 74, 62, 50}) {
      cv::imencode(".jpg", small, still.jpeg,
                   {cv::IMWRITE_JPEG_QUALITY, quality, cv::IMWRITE_JPEG_OPTIMIZE, 1});
      if (still.jpeg.size() <= most_bytes) return still;
    }
    if (std::max(small.cols, small.rows) <= 16) return still;
    scale *= 0.8;
  }
}

std::string base64(std::span<const unsigned char> bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < left ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= left ? kDigits[word >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

std::string data_uri(const Still& still) {
  return "data:image/jpeg;base64," + base64(still.jpeg);
}

std::vector<int> spread_evenly(std::span<const int> numbers, std::size_t count) {
  if (numbers.size() <= count) return {numbers.begin(), numbers.end()};
  std::vector<int> chosen;
  if (count == 0) return chosen;
  if (count == 1) return {numbers[numbers.size() / 2]};
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(numbers[i * (numbers.size() - 1) / (count - 1)]);
  return chosen;
}

}  // namespace emberfold::apps
