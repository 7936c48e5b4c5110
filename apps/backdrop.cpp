// SPDX-License-Identifier: Apache-2.0
#include "apps/backdrop.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "apps/byte_arrays.hpp"
#include "apps/interrupt.hpp"

namespace emberfold::apps {

namespace {

constexpr double kRestless = 5;  // grey levels, SD over the frames: what moves more is not still
constexpr int kMargin = 2;       // px that have to be still about a pixel

/// 255 where the sum of squared deviations is small in every channel.
cv::Mat still_pixels(const cv::Mat& deviations, double most) {
  std::vector<cv::Mat> channels;
  cv::split(deviations, channels);
  cv::Mat still = channels[0] <= most;
  for (std::size_t c = 1; c < channels.size(); ++c) still &= channels[c] <= most;
  const int side = 2 * kMargin + 1;
  cv::erode(still, still, cv::Mat::ones(side, side, CV_8U));
  return still;
}

}  // namespace

Backdrop measure_backdrop(core::FrameSource& source, const core::Context& context) {
  cv::Mat sum, squares;
  double count = 0;
  source.rewind();
  for (cv::Mat frame = source.next(); !frame.empty(); frame = source.next()) {
    if (context.cancelled()) throw Interrupted{};
    const cv::Mat levels = core::to_levels(frame, source.info());
    if (sum.empty()) {
      sum = cv::Mat::zeros(levels.size(), CV_64FC(levels.channels()));
      squares = sum.clone();
    }
    cv::accumulate(levels, sum);
    cv::accumulateSquare(levels, squares);
    ++count;
  }
  if (count == 0) return {};
  const cv::Mat mean = sum / count;
  Backdrop backdrop;
  backdrop.still = still_pixels(squares / count - mean.mul(mean), kRestless * kRestless);
  backdrop.levels = cv::Mat::zeros(mean.size(), CV_8UC(mean.channels()));
  cv::Mat bytes;
  mean.convertTo(bytes, CV_8U);
  bytes.copyTo(backdrop.levels, backdrop.still);
  return backdrop;
}

void add_backdrop(core::ModelArchive& archive, const Backdrop& backdrop) {
  if (backdrop.empty()) return;
  archive.arrays["backdrop"] = byte_array(backdrop.levels);
  archive.arrays["backdrop_still"] = byte_array(backdrop.still);
}

Backdrop read_backdrop(const core::ModelArchive& archive, cv::Size frame) {
  const auto found = archive.arrays.find("backdrop");
  if (found == archive.arrays.end() && !archive.arrays.contains("backdrop_still")) return {};
  const bool grey =
      found != archive.arrays.end() && found->second.shape.size() == 3 && found->second.shape.back() == 1;
  Backdrop backdrop{cv::Mat(frame, grey ? CV_8UC1 : CV_8UC3), cv::Mat(frame, CV_8U)};
  std::ranges::copy(byte_array(archive, "backdrop", frame, grey ? 1 : 3), backdrop.levels.data);
  std::ranges::transform(byte_array(archive, "backdrop_still", frame, 1), backdrop.still.data,
                         [](std::uint8_t flag) -> std::uint8_t { return flag != 0 ? 255 : 0; });
  return backdrop;
}

}  // namespace emberfold::apps
