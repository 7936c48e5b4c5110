// SPDX-License-Identifier: Apache-2.0
#include "core/io/frame_bytes.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::io {

namespace {

constexpr int kQuality = 95;

}  // namespace

std::vector<std::uint8_t> encode_frame(const cv::Mat& frame) {
  // The planes are stacked in one grey picture: JPEG would halve the resolution of colours.
  cv::Mat stacked = frame;
  if (frame.channels() == 3) {
    cv::Mat turned;
    cv::cvtColor(frame, turned, cv::COLOR_BGR2YCrCb);
    std::vector<cv::Mat> planes;
    cv::split(turned, planes);
    cv::vconcat(planes, stacked);
  }
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", stacked, bytes, {cv::IMWRITE_JPEG_QUALITY, kQuality});
  return bytes;
}

cv::Mat decode_frame(std::span<const std::uint8_t> bytes, cv::Size size, int channels) {
  const std::vector<std::uint8_t> copy(bytes.begin(), bytes.end());
  cv::Mat stacked;
  try {
    if (!copy.empty()) stacked = cv::imdecode(copy, cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception&) {
    stacked.release();
  }
  if (stacked.size() != cv::Size(size.width, size.height * channels))
    throw core::IoError("the bytes are no frame of " + core::size_text(size));
  if (channels == 1) return stacked;
  std::vector<cv::Mat> planes;
  for (int c = 0; c < channels; ++c)
    planes.push_back(stacked.rowRange(c * size.height, (c + 1) * size.height));
  cv::Mat turned, frame;
  cv::merge(planes, turned);
  cv::cvtColor(turned, frame, cv::COLOR_YCrCb2BGR);
  return frame;
}

}  // namespace emberfold::io
